#pragma once

#include "structure/fem/solver.hpp"

namespace strake::structure::fem {

/// The paper's plate with two cells through the thickness. It is fast, and exact enough for what is tested
/// here.
inline Parameters plate(Support left, Support right, MaterialModel model) {
  Parameters p;
  p.plate.length = 0.4;
  p.plate.thickness = 0.02;
  p.plate.left = left;
  p.plate.right = right;
  p.material.model = model;
  p.fem.refinement = 1;
  return p;
}

inline constexpr auto all_models = {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff,
                                    MaterialModel::neo_hookean};
inline constexpr auto both_models = {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff};

}  // namespace strake::structure::fem
