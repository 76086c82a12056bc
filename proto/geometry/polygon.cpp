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
