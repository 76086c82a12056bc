#pragma once

#include "fluid/geometry/surface_patches.hpp"
#include "fluid/geometry/triangle_grid.hpp"

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace strake::fluid {

/// The convex edges of a surface that are not sharp. The faces beside them meet in the plane that halves the
/// edge, and water goes around it from one face to the other.
class HalvedEdges {
 public:
  using Vector3 = Eigen::Vector3d;

  HalvedEdges() = default;
  explicit HalvedEdges(const SurfacePatches&);

  /// Sorts the edges into cells. position: of the mesh's points, 3×n; normal: of its triangles; least_cell:
  /// no cell is smaller [m].
  void build(const Eigen::Matrix3Xd& position, const Eigen::Matrix3Xd& normal, double least_cell);

  bool is_near(const Vector3& x, double limit) const { return grid_.nearest(x, limit).triangle >= 0; }
  /// Returns the shortest way from a to b over an edge between those two patches [m]; infinity from `limit`
  /// on.
  double way_around(const Vector3& a, int patch_a, const Vector3& b, int patch_b, double limit) const;
  /// Whether a and b lie before different sides of a chine within that patch, on a way over it shorter than
  /// `limit`.
  bool divides(const Vector3& a, const Vector3& b, int patch, double limit) const;

 private:
  /// The way from a to b over an edge: its length, and whether it passes the edge between its ends.
  struct Way {
    double length;
    bool between_ends;
  };
  Way way_over(int edge, const Vector3& a, const Vector3& b) const;
  bool is_passed(int edge, const Vector3& a, const Vector3& b) const;
  std::vector<std::pair<int, int>> patches_;    // beside each edge, the smaller number first
  std::vector<std::pair<int, int>> triangles_;  // beside a chine within a patch; else −1
  bool has_within_ = false;                     // any of those
  Eigen::Matrix3Xi ends_;                       // from, to, to: triangles without area
  Eigen::Matrix3Xd across_;                     // normal of the plane that halves such a chine
  Eigen::Matrix3Xd position_;
  TriangleGrid grid_;
};

}  // namespace strake::fluid
