#include "structure/body/shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

using Vector2 = Eigen::Vector2d;

/// A corner sharper than this encloses nothing that particles could fill.
constexpr double sharpest_corner = 5 * std::numbers::pi / 180;  // [rad]

/// Whether the segments a–b and c–d have a point in common.
bool meet(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  const Vector2 u = b - a, v = d - c, w = c - a;
  const double det = cross(u, v);
  if (std::abs(det) <= 1e-14 * u.norm() * v.norm()) {  // parallel: on one line, and overlapping?
    if (std::abs(cross(w, u)) > 1e-12 * u.norm() * std::max(w.norm(), u.norm())) return false;
    const double s = w.dot(u) / u.squaredNorm(), t = (d - a).dot(u) / u.squaredNorm();
    return std::max(s, t) >= 0 && std::min(s, t) <= 1;
  }
  const double s = cross(w, v) / det, t = cross(w, u) / det;
  return s >= 0 && s <= 1 && t >= 0 && t <= 1;
}

std::string text(const Vector2& x) {
  return fmt::format("({:.6g}, {:.6g})", x.x(), x.y());
}

}  // namespace

double draught(const Wedge& wedge) {
  return 0.5 * wedge.width * std::tan(wedge.deadrise);
}

std::vector<Vector2> wedge_polygon(const Wedge& wedge) {
  const Vector2 apex = wedge.apex.head<2>(), half(0.5 * wedge.width, 0), up(0, 1);
  const double chine = draught(wedge);
  Polygon p = {apex, apex + half + chine * up};
  if (wedge.height > chine * (1 + 1e-9)) {
    p.push_back(apex + half + wedge.height * up);
    p.push_back(apex - half + wedge.height * up);
  }
  p.push_back(apex - half + chine * up);
  return p;
}

std::vector<Vector2> circle_polygon(const Vector2& centre, double radius, double spacing) {
  constexpr int fewest = 6;  // corners to a quarter, so that a turn stays below what counts as a corner
  const int quarter =
      std::max(fewest, static_cast<int>(std::lround(0.5 * std::numbers::pi * radius / spacing)));
  const int n = 4 * quarter;
  // n triangles of area ½ R² sin(2π/n) have the area π r² together.
  const double turn = 2 * std::numbers::pi / n, outer = radius * std::sqrt(turn / std::sin(turn));
  Polygon p;
  for (int i = 0; i < n; ++i)
    p.emplace_back(centre.x() + outer * std::sin(i * turn), centre.y() - outer * std::cos(i * turn));
  return p;
}

PolygonFault polygon_fault(const Polygon& p) {
  const std::size_t n = p.size();
  if (n < 3) return {fmt::format("it has {} corners", n), "give at least three"};
  for (std::size_t i = 0; i < n; ++i) {
    const double length = (following(p, i) - p[i]).norm();
    if (length == 0)
      return {fmt::format("the corner {} is given twice in a row{}", text(p[i]),
                          i == n - 1 ? ", first and last" : ""),
              i == n - 1 ? "leave the last corner out: the outline closes itself" : "leave one of them out"};
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      if (j == i + 1 || (i == 0 && j == n - 1)) continue;  // they share a corner
      if (meet(p[i], following(p, i), p[j], following(p, j)))
        return {fmt::format("the edge from {} to {} crosses or touches the one from {} to {}", text(p[i]),
                            text(following(p, i)), text(p[j]), text(following(p, j))),
                "give the corners in their order around the body"};
    }
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2 back = p[(i + n - 1) % n] - p[i], on = following(p, i) - p[i];
    const double angle = std::abs(std::atan2(cross(on, back), on.dot(back)));
    if (angle < sharpest_corner)
      return {
          fmt::format("the corner at {} is {:.2g} degrees sharp", text(p[i]), angle * 180 / std::numbers::pi),
          "blunt it to at least 5 degrees"};
  }
  if (!(polygon_area(p) > 0)) return {"it is walked clockwise", "give the corners in the opposite order"};
  return {};
}

}  // namespace strake::structure
