#include "proto/geometry/polygon.hpp"

#include <algorithm>
#include <limits>

namespace strake {

bool inside_polygon(const Polygon& p, const Eigen::Vector2d& x) {
  bool odd = false;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (ray_crosses(p[i], following(p, i), x)) odd = !odd;
  return odd;
}

double polygon_area(const Polygon& p) {
  double area = 0;
  for (std::size_t i = 0; i < p.size(); ++i) area += 0.5 * cross(p[i] - p[0], following(p, i) - p[0]);
  return area;
}

Polygon cut_polygon(const Polygon& polygon, int axis, double limit, double s) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d &a = polygon[k], &b = following(polygon, k);
    const double ha = s * (limit - a[axis]), hb = s * (limit - b[axis]);
    if (ha >= 0) kept.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) kept.push_back(a + ha / (ha - hb) * (b - a));
  }
  return kept;
}

double distance_to_polygon(const Polygon& p, const Eigen::Vector2d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Eigen::Vector2d t = following(p, i) - p[i];
    const double s = std::clamp((x - p[i]).dot(t) / t.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (x - p[i] - s * t).norm());
  }
  return nearest;
}

}  // namespace strake
