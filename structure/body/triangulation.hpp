#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace strake::structure {

/// A plane polygon cut into triangles, counter-clockwise; the first points are those of the polygon, further
/// ones lie inside. No edge of the polygon is divided.
struct Triangulation {
  std::vector<Eigen::Vector2d> point;
  std::vector<std::array<int, 3>> triangle;
};

/// polygon: simple, counter-clockwise, its points about `spacing` [m] apart (straight angles are welcome).
/// Ears are cut off, inner edges longer than 1.5 spacings are halved, and edges flipped until no triangle's
/// circumcircle contains the corner across an edge (Lawson).
Triangulation triangulate(const std::vector<Eigen::Vector2d>& polygon, double spacing);

}  // namespace strake::structure
