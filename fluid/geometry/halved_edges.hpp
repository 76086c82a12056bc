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

  /// Sorts the edges into cells. position: of the mesh's points, 3×n; least_cell: no cell is smaller [m].
  void build(const Eigen::Matrix3Xd& position, double least_cell);

  bool is_near(const Vector3& x, double limit) const { return grid_.nearest(x, limit).triangle >= 0; }
  /// Returns the shortest way from a to b over an edge between those two patches [m]; infinity from `limit`
  /// on.
  double way_around(const Vector3& a, int patch_a, const Vector3& b, int patch_b, double limit) const;

 private:
  std::vector<std::pair<int, int>> patches_;  // beside each edge, the smaller number first
  Eigen::Matrix3Xi ends_;                     // from, to, to: triangles without area
  Eigen::Matrix3Xd position_;
  TriangleGrid grid_;
};

}  // namespace strake::fluid
