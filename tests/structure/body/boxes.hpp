#pragma once

#include "structure/body/parameters.hpp"
#include "structure/body/solid.hpp"

#include <string>
#include <vector>

namespace strake::structure {

/// One box of a union, of steel unless another material is given.
inline SolidBox box(const std::string& name, const Eigen::Vector3d& min, const Eigen::Vector3d& max,
                    const Material& material = {}) {
  SolidBox b;
  b.name = name;
  b.min = min;
  b.max = max;
  b.material = material;
  return b;
}

/// The same of a soft linear material.
inline SolidBox soft_box(const std::string& name, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  return box(name, min, max, {.model = MaterialModel::linear, .density = 1000, .young = 1e6, .poisson = 0.3});
}

/// A bar of 4 × 2 × 2 cells as from a mesh file, 1 m long, that is twisted about x by `warp` [m] at its ends'
/// corners; its ends are warped as much. "root" is its left end, clamped, "deck" its upper side.
inline Solid warped_bar(double warp) {
  Solid solid;
  solid.dimension = 3;
  solid.parts = {{"bar", soft_box("bar", {0, 0, 0}, {1, 1, 1}).material}};
  solid.plane = {std::vector<double>{0, 0.25, 0.5, 0.75, 1}, {0, 0.05, 0.1}, {0, 0.1, 0.2}};
  fill_grid(solid, [](const auto&) { return 0; });
  find_facets(solid);
  solid.supported = {{"root", Support::clamped, facets_named(solid, "left")},
                     {"deck", Support::free, facets_named(solid, "top")}};
  solid.plane = {};
  for (Eigen::Index i = 0; i < solid.node.cols(); ++i) {
    const Eigen::Vector3d X = solid.node.col(i);
    const double across = (X.z() - 0.1) / 0.1;  // from -1 to 1
    solid.node(0, i) += warp * across * (X.y() - 0.05) / 0.05;
    solid.node(1, i) += warp * across * X.x();
  }
  return solid;
}

/// A body of such boxes; surface_spacing: of the points of its wet surface [m].
inline Parameters body_of_boxes(int dimension, const std::vector<SolidBox>& boxes, int refinement,
                                double surface_spacing) {
  Parameters p;
  p.dimension = dimension;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(dimension, boxes);
  if (dimension == 2) p.shape.corner = outer_polygons(p.solid).front();
  p.fem.refinement = refinement;
  p.surface_spacing = surface_spacing;
  return p;
}

}  // namespace strake::structure
