#pragma once

#include "fluid/boundary.hpp"
#include "fluid/kernel.hpp"
#include "fluid/neighbours.hpp"
#include "fluid/operators.hpp"
#include "fluid/parameters.hpp"
#include "fluid/state.hpp"

#include <Eigen/Core>

#include <span>

namespace strake::fluid {

/// ∇P [Pa/m] of PHYSICS §2 (19) and §10.1 as the scheme chooses it, at the rows that `row` marks. Surface
/// particles and dry rows stand in the sums with P = 0, dummies with their Neumann pressure. In the symmetric
/// form a pair with a row of the tank acts along the wall's normal alone: the wall is smooth, and its
/// particles must not hold the water like teeth (a column of water hangs on its side walls otherwise).
template <int dim>
Vectors<dim> pressure_gradient(const State<dim>&, const Boundary<dim>&, const Neighbours& near,
                               const LatticeConstants& lattice, Gradient kind, const Masks& masks);

/// Particle shifting (PHYSICS §10.4): δr_i = −A (|u_i| + U) Δt l0 ∇C_i, U the fall over one spacing √(g l0),
/// ∇C_i = (d/n0) Σ_j w r_ij/r², at most 0.1 l0. At the surface the part along the surface normal (the
/// direction of ∇C) is left out, which leaves nothing of ∇C itself: there the particle follows the mean shift
/// of its inner neighbours along the surface. A: scheme.shifting; 0 shifts nothing.
template <int dim>
void shift_particles(State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                     const LatticeConstants& lattice, double strength, double rest_speed, double dt,
                     double spacing);

}  // namespace strake::fluid
