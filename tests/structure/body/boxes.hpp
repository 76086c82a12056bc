#pragma once

#include "structure/body/solid.hpp"

#include <string>

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

}  // namespace strake::structure
