#pragma once

#include "fluid/geometry/surface_patches.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::fluid {

/// Places on a surface of triangles, about one to each l0². They move with the triangles.
struct WetPoints {
  struct Point {
    int triangle = 0;
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();  // of its corners
    int patch = 0;
  };
  /// The part of a triangle's area that belongs to a point. The parts of each triangle sum to 1.
  struct Share {
    int point = 0, triangle = 0;
    double part = 0;
  };
  std::vector<Point> point;  // part after part
  std::vector<Share> share;  // by points
};

/// Distributes wet points over each part of a patch between its chines and knuckles. A plane rectangle is
/// divided evenly. On other parts each place is the middle of the area that is nearest to it (a centroidal
/// Voronoi tessellation).
WetPoints wet_points(const InterfaceMesh&, const SurfacePatches&, double spacing);

}  // namespace strake::fluid
