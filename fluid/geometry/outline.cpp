#include "fluid/geometry/outline.hpp"

#include "proto/error.hpp"
#include "proto/geometry/polygon.hpp"
#include "proto/geometry/thinning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

/// The points where a closed outline turns.
Polygon bends_of(const Polygon& points) {
  Polygon bends;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Eigen::Vector2d before = points[k] - points[(k + points.size() - 1) % points.size()];
    if (std::abs(turn(before, following(points, k) - points[k])) > flat_angle) bends.push_back(points[k]);
  }
  return bends;
}

}  // namespace

std::vector<std::vector<int>> loops_of(const InterfaceMesh& partner) {
  const auto n = static_cast<std::size_t>(partner.position.cols());
  std::vector<int> next(n, -1);
  std::vector<char> entered(n, 0);
  for (Eigen::Index f = 0; f < partner.faces.cols(); ++f) {
    const int a = partner.faces(0, f), b = partner.faces(1, f);
    if (next[static_cast<std::size_t>(a)] >= 0 || entered[static_cast<std::size_t>(b)])
      throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", partner.name),
                  fmt::format("more than two faces meet at point {} or {}", a, b),
                  "give the wet surface as closed chains of segments, each walked counter-clockwise");
    next[static_cast<std::size_t>(a)] = b;
    entered[static_cast<std::size_t>(b)] = 1;
  }
  std::vector<std::vector<int>> loops;
  for (std::size_t p = 0; p < n; ++p) {
    if (next[p] < 0) continue;
    std::vector<int> loop;
    for (int at = static_cast<int>(p); next[static_cast<std::size_t>(at)] >= 0;) {
      loop.push_back(at);
      const int to = next[static_cast<std::size_t>(at)];
      next[static_cast<std::size_t>(at)] = -1;
      at = to;
      if (at != static_cast<int>(p) && next[static_cast<std::size_t>(at)] < 0)
        throw Error(ExitCode::case_file, fmt::format("interface \"{}\"", partner.name),
                    fmt::format("the wet surface ends at point {} instead of closing", at),
                    "the fluid needs to know inside from outside: close the outline");
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

Outline::Outline(const InterfaceMesh& partner, const std::vector<int>& loop, double spacing,
                 const Knuckles& knuckles) {
  Polygon points;
  for (const int k : loop) points.emplace_back(partner.position.col(k).head<2>());
  const Polygon corners = bends_of(points), plain = without_details(corners, spacing);
  if (plain.size() != corners.size()) points = plain;
  const std::size_t n = points.size();
  place.resize(2, static_cast<Eigen::Index>(n));
  for (std::size_t k = 0; k < n; ++k) place.col(static_cast<Eigen::Index>(k)) = points[k];
  turn.resize(n);
  bend.assign(n, Bend::smooth);
  std::vector<std::size_t> bends;  // points where the outline turns; others only divide a straight face
  for (std::size_t k = 0; k < n; ++k) {
    turn[k] = strake::turn(at(k) - at(k + n - 1), at(k + 1) - at(k));
    if (std::abs(turn[k]) > flat_angle) bends.push_back(k);
  }
  for (std::size_t b = 0; b < bends.size(); ++b) {
    const std::size_t k = bends[b];
    double beside = 0;
    for (const std::size_t step : {std::size_t{1}, bends.size() - 1})
      if (const double other = std::abs(turn[bends[(b + step) % bends.size()]]); other <= corner_angle)
        beside = std::max(beside, other);
    bend[k] = bend_of(turn[k], beside, normal(k + n - 1), normal(k), knuckles);
  }
}

}  // namespace strake::fluid
