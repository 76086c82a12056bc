#pragma once

#include "fluid/mps/operators.hpp"

#include <Eigen/Core>

namespace strake::fluid {

/// Computes ν∇²u [m/s²] with the Laplacian of fluid/THEORY.md (F18). kinematic_viscosity: ν [m²/s]. The sum
/// over all rows of the mask vanishes. So the value at a body's layer particle times its mass is the reaction
/// on it.
template <int dim>
Vectors<dim> viscous_acceleration(const Vectors<dim>& velocity, const Neighbours& rows,
                                  const LatticeConstants& laplacian_lattice, double kinematic_viscosity,
                                  const Masks& = {});

}  // namespace strake::fluid
