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
