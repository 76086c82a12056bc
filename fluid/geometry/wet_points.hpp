#pragma once

#include "fluid/geometry/surface_patches.hpp"
#include "proto/interface.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::fluid {

/// Places on a surface of triangles, about one to each l0², that move along with it.
struct WetPoints {
  struct Point {
    int triangle = 0;
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();  // of its corners
    int patch = 0;
  };
  /// Part of a triangle that a point stands for; the parts of each triangle sum to 1.
  struct Share {
    int point = 0, triangle = 0;
    double part = 0;
  };
  std::vector<Point> point;  // patch after patch
  std::vector<Share> share;  // by points
};

/// A plane rectangle is divided evenly; other patches get places that are the middles of what is nearest to
/// each of them (a centroidal Voronoi tessellation).
WetPoints wet_points(const InterfaceMesh&, const SurfacePatches&, double spacing);

}  // namespace strake::fluid
