#pragma once

#include "structure/body/parameters.hpp"

namespace strake::structure {

/// The paper's steel plate, 0.4 × 0.02 m, both ends clamped, at rest.
inline Parameters paper_plate(int layers, ParticleModel model = ParticleModel::total_lagrangian) {
  Parameters p;
  p.kind = "particle";
  p.plate.length = 0.4;
  p.plate.thickness = 0.02;
  p.plate.left = p.plate.right = Support::clamped;
  p.particle.spacing = p.plate.thickness / layers;
  p.particle.model = model;
  if (model == ParticleModel::pair) p.particle.clamp = ClampColumn::outside;
  return p;
}

}  // namespace strake::structure
