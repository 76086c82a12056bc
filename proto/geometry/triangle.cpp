#include "proto/geometry/triangle.hpp"

#include <algorithm>
#include <limits>

namespace strake {

double distance_to_segment(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& x) {
  const Eigen::Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double s = length > 0 ? std::clamp((x - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (x - a - s * along).norm();
}

Eigen::Vector3d nearest_in_triangle(const Eigen::Matrix3d& corner, const Eigen::Vector3d& x) {
  const Eigen::Vector3d u = corner.col(1) - corner.col(0), v = corner.col(2) - corner.col(0),
                        w = x - corner.col(0);
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), det = uu * vv - uv * uv;
  const double s = (vv * u.dot(w) - uv * v.dot(w)) / det, t = (uu * v.dot(w) - uv * u.dot(w)) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Index l = (k + 1) % 3;
    const Eigen::Vector3d along = corner.col(l) - corner.col(k);
    const double r = std::clamp((x - corner.col(k)).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (x - corner.col(k) - r * along).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    best.setZero();
    best[k] = 1 - r;
    best[l] = r;
  }
  return best;
}

}  // namespace strake
