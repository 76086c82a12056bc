#include "structure/mesh_files/stl_body.hpp"

#include "proto/error.hpp"
#include "proto/mesh_files/stl.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double merged = 1e-6;   // of the extent: corners nearer together are one point
constexpr double no_area = 1e-9;  // of the extent: height of a triangle without area

/// Points of which none is nearer to another than `near`, found by the cells of a grid.
class Merger {
 public:
  /// origin: a place near the body, from which the grid counts.
  Merger(double near, const Vector3d& origin) : near_(near), origin_(origin) {}

  /// The number of the point for a place; `moved` counts places that are not exactly their point.
  int number(const Vector3d& X) {
    constexpr double cell = 8;  // widths of `near`, so that most places need one cell alone
    std::array<std::array<std::int64_t, 2>, 3> span{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t side = 0; side < 2; ++side) {
        const double x =
            X[static_cast<Index>(axis)] - origin_[static_cast<Index>(axis)] + (side == 0 ? -near_ : near_);
        span[axis][side] = static_cast<std::int64_t>(std::floor(x / (cell * near_)));
      }
    int nearest = -1;
    double distance = near_;
    for (std::int64_t i = span[0][0]; i <= span[0][1]; ++i)
      for (std::int64_t j = span[1][0]; j <= span[1][1]; ++j)
        for (std::int64_t k = span[2][0]; k <= span[2][1]; ++k)
          if (const auto found = grid_.find(hash(i, j, k)); found != grid_.end())
            for (const int candidate : found->second)
              if (const double d = (point[static_cast<std::size_t>(candidate)] - X).norm(); d <= distance) {
                distance = d;
                nearest = candidate;
              }
    if (nearest >= 0) {
      if (distance > 0) ++moved;
      return nearest;
    }
    const auto own = [&](Index axis) {
      return static_cast<std::int64_t>(std::floor((X[axis] - origin_[axis]) / (cell * near_)));
    };
    grid_[hash(own(0), own(1), own(2))].push_back(static_cast<int>(point.size()));
    point.push_back(X);
    return static_cast<int>(point.size()) - 1;
  }

  std::vector<Vector3d> point;
  long moved = 0;

 private:
  /// Cells may share a number: distances decide.
  static std::uint64_t hash(std::int64_t i, std::int64_t j, std::int64_t k) {
    return static_cast<std::uint64_t>(i) * 0x9E3779B97F4A7C15U ^
           static_cast<std::uint64_t>(j) * 0xC2B2AE3D27D4EB4FU ^
           static_cast<std::uint64_t>(k) * 0x165667B19E3779F9U;
  }
  double near_;
  Vector3d origin_;
  std::unordered_map<std::uint64_t, std::vector<int>> grid_;
};

/// A surface whose triangles know their number in the file.
struct Numbered {
  ClosedSurface surface;
  std::vector<Index> number;  // m, from 1
};

Numbered merge_corners(const Points& corner, const std::string& file) {
  const double extent = (corner.rowwise().maxCoeff() - corner.rowwise().minCoeff()).maxCoeff();
  if (!(extent > 0))
    throw Error(ExitCode::case_file, file, fmt::format("all corners lie at {}", place_text(corner.col(0))),
                "export a body with a size");
  constexpr double largest = 1e9;  // in whatever unit: no ship
  if (!(extent < largest))
    throw Error(ExitCode::case_file, file, fmt::format("the body is {:.3g} long", extent),
                "look for a broken corner, or export in m or mm");
  Merger merger(merged * extent, corner.col(0));
  Numbered all;
  std::vector<std::array<int, 3>> kept;
  for (Index t = 0; t < corner.cols() / 3; ++t) {
    std::array<int, 3> of{};
    for (Index k = 0; k < 3; ++k) of[static_cast<std::size_t>(k)] = merger.number(corner.col(3 * t + k));
    if (of[0] == of[1] || of[1] == of[2] || of[2] == of[0]) continue;
    const auto at = [&](std::size_t k) -> const Vector3d& {
      return merger.point[static_cast<std::size_t>(of[k])];
    };
    const double longest = std::max({(at(1) - at(0)).norm(), (at(2) - at(1)).norm(), (at(0) - at(2)).norm()});
    if ((at(1) - at(0)).cross(at(2) - at(0)).norm() < no_area * extent * longest)
      throw Error(ExitCode::case_file, file,
                  fmt::format("triangle {} has no area: its corners {}, {} and {} lie on one line", t + 1,
                              place_text(at(0)), place_text(at(1)), place_text(at(2))),
                  "let the program that wrote the file repair its mesh, or mesh the body anew");
    kept.push_back(of);
    all.number.push_back(t + 1);
  }
  ClosedSurface& surface = all.surface;
  surface.point.resize(3, static_cast<Index>(merger.point.size()));
  for (std::size_t i = 0; i < merger.point.size(); ++i)
    surface.point.col(static_cast<Index>(i)) = merger.point[i];
  surface.triangle.resize(3, static_cast<Index>(kept.size()));
  for (std::size_t t = 0; t < kept.size(); ++t)
    surface.triangle.col(static_cast<Index>(t)) << kept[t][0], kept[t][1], kept[t][2];
  const Index dropped = corner.cols() / 3 - surface.triangle.cols();
  surface.lines.push_back(
      fmt::format("STL file   {} triangles   {} points", kept.size(), merger.point.size()));
  if (merger.moved > 0)
    surface.lines.push_back(fmt::format("{} corners within {:.3g} (the file's unit) of another point: merged",
                                        merger.moved, merged * extent));
  if (dropped > 0) surface.lines.push_back(fmt::format("{} triangles without area: left out", dropped));
  return all;
}

/// Refuses edges that have not two triangles of opposite direction.
void check_edges(const Numbered& all, const std::string& file) {
  struct Side {
    int low, high;
    bool rising;
    Index triangle;  // its number in the file
    bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
  };
  std::vector<Side> sides;
  for (Index t = 0; t < all.surface.triangle.cols(); ++t)
    for (Index k = 0; k < 3; ++k) {
      const int a = all.surface.triangle(k, t), b = all.surface.triangle((k + 1) % 3, t);
      sides.push_back({std::min(a, b), std::max(a, b), a < b, all.number[static_cast<std::size_t>(t)]});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  struct Fault {
    long count = 0;
    std::string first;
  } open, crowded, turned;
  const auto note = [&](Fault& fault, std::size_t from, std::size_t to) {
    if (++fault.count > 1) return;
    fault.first = fmt::format("from {} to {}, triangle{}", place_text(all.surface.point.col(sides[from].low)),
                              place_text(all.surface.point.col(sides[from].high)), to - from > 1 ? "s" : "");
    for (std::size_t i = from; i < to; ++i)
      fault.first += fmt::format("{} {}", i > from ? "," : "", sides[i].triangle);
  };
  for (std::size_t from = 0, to = 0; from < sides.size(); from = to) {
    while (to < sides.size() && sides[to].same_edge(sides[from])) ++to;
    if (to - from == 1)
      note(open, from, to);
    else if (to - from > 2)
      note(crowded, from, to);
    else if (sides[from].rising == sides[from + 1].rising)
      note(turned, from, to);
  }
  const auto refuse = [&](const Fault& fault, const std::string& what, const std::string& fix) {
    if (fault.count > 0)
      throw Error(ExitCode::case_file, file,
                  fmt::format("{}: {}; the first {}", what, fault.count, fault.first), fix);
  };
  refuse(open, "the surface is not closed, edges with one triangle alone",
         "close the holes in the program that wrote the file, e.g. a deck and a transom on a hull");
  refuse(crowded, "edges with more than two triangles",
         "join the bodies into one solid, without walls inside it, and export it anew");
  refuse(turned, "edges whose two triangles are turned against one another",
         "unify the normals in the program that wrote the file");
}

/// Refuses a surface that goes through itself: what it encloses would be counted twice, or not at all.
void check_cuts(const Numbered& all, const std::string& file) {
  const Points& point = all.surface.point;
  const double extent = (point.rowwise().maxCoeff() - point.rowwise().minCoeff()).maxCoeff();
  const SelfCuts cuts = find_self_cuts(all.surface, merged * extent);
  if (cuts.pairs == 0) return;
  const auto number = [&](std::size_t k) { return all.number[static_cast<std::size_t>(cuts.first[k])]; };
  throw Error(
      ExitCode::case_file, file,
      fmt::format("the surface cuts itself: {} pairs of triangles; the first, {} and {}, at {}", cuts.pairs,
                  number(0), number(1), place_text(cuts.place)),
      "unite overlapping bodies (a Boolean union) in the program that wrote the file, or let it repair "
      "its mesh");
}

}  // namespace

ClosedSurface read_stl_body(const std::filesystem::path& path) {
  Numbered all = merge_corners(read_stl(path), path.string());
  check_edges(all, path.string());
  check_cuts(all, path.string());
  sort_shells(all.surface, path.string());
  return std::move(all.surface);
}

}  // namespace strake::structure
