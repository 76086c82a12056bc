#pragma once

#include <Eigen/Core>

#include <cmath>
#include <vector>

// Closed polygons in the plane, as their corners in order [m]; counter-clockwise ones have a positive area.

namespace strake {

using Polygon = std::vector<Eigen::Vector2d>;

/// a × b = a_x b_y − a_y b_x.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Angle from one direction to another in (−π, π], positive counter-clockwise [rad].
inline double turn(const Eigen::Vector2d& before, const Eigen::Vector2d& after) {
  return std::atan2(cross(before, after), before.dot(after));
}

/// Whether the ray from x along +x crosses the edge from a to b. An end of the edge belongs to it where the
/// other end lies above, so that a ray through a corner counts one of its two edges, or both or none.
inline bool ray_crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& x) {
  if ((a.y() > x.y()) == (b.y() > x.y())) return false;
  return x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

/// The corner after corner i.
inline const Eigen::Vector2d& following(const Polygon& p, std::size_t i) {
  return p[(i + 1) % p.size()];
}

bool inside_polygon(const Polygon&, const Eigen::Vector2d& x);
double polygon_area(const Polygon&);  // [m²], negative when clockwise
/// The part with s·x[axis] ≤ s·limit, s = ±1, of a polygon without reflex corners; empty where none is.
Polygon cut_polygon(const Polygon&, int axis, double limit, double s);
double distance_to_polygon(const Polygon&, const Eigen::Vector2d& x);  // to its edges [m]

}  // namespace strake
