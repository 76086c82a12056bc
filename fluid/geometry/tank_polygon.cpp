#include "fluid/geometry/tank_polygon.hpp"

#include "proto/geometry/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace strake::fluid {
namespace {

using Vector2 = Eigen::Vector2d;
/// Corners sharper than this have no room for layers of particles.
constexpr double sharpest = 0.35;  // [rad], 20 degrees
constexpr double shortest = 2;     // edge [l0]

bool segments_cross(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  for (int axis = 0; axis < 2; ++axis)  // edges on one line cross only where they overlap
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  return cross(b - a, c - a) * cross(b - a, d - a) <= 0 && cross(d - c, a - c) * cross(d - c, b - c) <= 0;
}

/// Returns the ends of the shortest line between two edges that do not cross. One of the ends is a corner.
std::pair<Vector2, Vector2> shortest_way(const Vector2& a, const Vector2& b, const Vector2& c,
                                         const Vector2& d) {
  std::pair<Vector2, Vector2> best{a, c};
  const auto try_corner = [&](const Vector2& x, const Vector2& from, const Vector2& to) {
    const Vector2 t = to - from;
    const Vector2 foot = from + std::clamp((x - from).dot(t) / t.squaredNorm(), 0.0, 1.0) * t;
    if ((x - foot).norm() < (best.first - best.second).norm()) best = {x, foot};
  };
  try_corner(a, c, d);
  try_corner(b, c, d);
  try_corner(c, a, b);
  try_corner(d, a, b);
  return best;
}

}  // namespace

std::string polygon_fault(const Parameters& p, double reach) {
  Polygon corners;
  for (const auto& corner : p.tank_polygon) corners.emplace_back(corner.head<2>());
  const std::size_t n = corners.size();
  const auto name = [&](std::size_t k) {
    return fmt::format("({:.6g}, {:.6g})", corners[k % n].x(), corners[k % n].y());
  };
  double area = 0;
  for (std::size_t k = 0; k < n; ++k) area += 0.5 * cross(corners[k], corners[(k + 1) % n]);
  if (!(area > 0)) return "corners in counter-clockwise order";
  // An upright open side below the water is a wall that was forgotten, not a rim.
  const Vector2 rim = corners.front() - corners.back();
  const double lower = std::min(corners.front().y(), corners.back().y());
  if (p.open_top && std::abs(rim.y()) > std::abs(rim.x()) && lower < p.water.max.y() - 1e-6 * p.spacing)
    return fmt::format(
        "the first and the last corner at the rim: no wall stands between {} and {}, and the water reaches "
        "up "
        "to {:.6g} m (or open_top = false)",
        name(n - 1), name(0), p.water.max.y());
  for (std::size_t k = 0; k < n; ++k) {
    if (p.open_top && k + 1 == n) continue;  // no wall
    const Vector2 before = corners[k] - corners[(k + n - 1) % n], after = corners[(k + 1) % n] - corners[k];
    if (after.norm() < shortest * p.spacing)
      return fmt::format("edges of at least {:g} spacings: the one from {} is {:.3g} m long", shortest,
                         name(k), after.norm());
    if (!(p.open_top && k == 0) && std::abs(turn(before, after)) > std::numbers::pi - sharpest)
      return fmt::format("corners of at least {:.0f} degrees: the one at {} is sharper",
                         sharpest * 180 / std::numbers::pi, name(k));
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Vector2 &a = corners[i], &b = corners[i + 1], &c = corners[j], &d = corners[(j + 1) % n];
      if (segments_cross(a, b, c, d))
        return fmt::format("edges that do not cross: those from {} and {} do", name(i), name(j));
      if (p.open_top && j == n - 1) continue;
      const auto [from, to] = shortest_way(a, b, c, d);
      if ((to - from).norm() < reach && !inside_polygon(corners, 0.5 * (from + to)))
        return fmt::format(
            "walls at least {:.3g} m thick, or the water on both sides would meet: between the edges from {} "
            "and {} it is {:.3g} m",
            reach, name(i), name(j), (to - from).norm());
    }
  return {};
}

}  // namespace strake::fluid
