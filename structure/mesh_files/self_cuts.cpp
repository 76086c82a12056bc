#include "structure/mesh_files/stl_body.hpp"

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Bounds = Eigen::AlignedBox3d;

/// Asks the tree for all pairs of triangles whose boxes meet, and counts those that cut.
class CutFinder {
 public:
  CutFinder(const ClosedSurface& surface, double slack) : surface_(surface), slack_(slack) {
    for (Index t = 0; t < surface.triangle.cols(); ++t) {
      Bounds box;
      for (Index k = 0; k < 3; ++k) box.extend(corner(t, k));
      boxes.push_back(box);
    }
  }

  // What Eigen's BVIntersect asks. The tree meets itself, so that each pair comes twice.
  bool intersectVolumeVolume(const Bounds& a, const Bounds& b) const { return a.intersects(b); }
  bool intersectVolumeObject(const Bounds& a, int t) const { return a.intersects(boxes[at(t)]); }
  bool intersectObjectVolume(int t, const Bounds& b) const { return b.intersects(boxes[at(t)]); }
  bool intersectObjectObject(int one, int other) {
    if (one >= other || !boxes[at(one)].intersects(boxes[at(other)])) return false;
    auto place = cut(one, other);
    if (!place) place = cut(other, one);
    if (!place) return false;
    const std::array<Index, 2> pair = {one, other};
    if (found.pairs == 0 || pair < found.first) {
      found.first = pair;
      found.place = *place;
    }
    ++found.pairs;
    return false;  // go on
  }

  std::vector<Bounds> boxes;
  SelfCuts found;

 private:
  static std::size_t at(int t) { return static_cast<std::size_t>(t); }
  Vector3d corner(Index t, Index k) const { return surface_.point.col(surface_.triangle(k, t)); }
  bool has(Index t, int point) const { return (surface_.triangle.col(t).array() == point).any(); }

  /// Returns where an edge of `cutting` goes through `plane`; edges from a corner that both share do not.
  std::optional<Vector3d> cut(Index cutting, Index plane) const {
    for (Index k = 0; k < 3; ++k) {
      const Index next = (k + 1) % 3;
      if (has(plane, surface_.triangle(k, cutting)) || has(plane, surface_.triangle(next, cutting))) continue;
      if (const auto place = pierce(corner(cutting, k), corner(cutting, next), plane)) return place;
    }
    return std::nullopt;
  }

  /// Returns where the segment from a to b goes through triangle t of the corners u, v, w. With the unit
  /// normal n its ends have the heights h_a = (a − u)·n and h_b, of different signs and beyond `slack`. The
  /// place x = a + h_a/(h_a − h_b) (b − a) is inside by more than `slack` if
  ///   ((v − u) × (x − u))·n / |v − u| > slack
  /// for each of the edges. So a body that stands on another with its edge is not cut.
  std::optional<Vector3d> pierce(const Vector3d& a, const Vector3d& b, Index t) const {
    const Vector3d u = corner(t, 0);
    const Vector3d n = (corner(t, 1) - u).cross(corner(t, 2) - u).normalized();
    const double above = (a - u).dot(n), below = (b - u).dot(n);
    if (above * below >= 0 || std::min(std::abs(above), std::abs(below)) <= slack_) return std::nullopt;
    const Vector3d x = a + above / (above - below) * (b - a);
    for (Index k = 0; k < 3; ++k) {
      const Vector3d from = corner(t, k), along = corner(t, (k + 1) % 3) - from;
      if (along.cross(x - from).dot(n) <= slack_ * along.norm()) return std::nullopt;
    }
    return x;
  }

  const ClosedSurface& surface_;
  double slack_;
};

}  // namespace

SelfCuts find_self_cuts(const ClosedSurface& surface, double slack) {
  CutFinder finder(surface, slack);
  std::vector<int> number(finder.boxes.size());
  std::iota(number.begin(), number.end(), 0);
  const Eigen::KdBVH<double, 3, int> tree(number.begin(), number.end(), finder.boxes.begin(),
                                          finder.boxes.end());
  Eigen::BVIntersect(tree, tree, finder);
  return finder.found;
}

}  // namespace strake::structure
