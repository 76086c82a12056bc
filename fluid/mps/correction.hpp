#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/mps/operators.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

namespace strake::fluid {

/// Computes ∇P [Pa/m] of fluid/THEORY.md (F16), (F19) or (F20), at the particles that `masks.row` marks.
/// `kind` chooses the form. Surface particles and dry layer particles enter the sums with P = 0, dummies with
/// their Neumann pressure. In the symmetric form a pair with a tank particle acts along the wall's normal
/// alone. The wall is smooth: otherwise its particles would carry the water at the side walls. level:
/// `face_level` of the water, or empty.
template <int dim>
Vectors<dim> pressure_gradient(const State<dim>&, const Boundary<dim>&, const Neighbours& near,
                               const LatticeConstants& lattice, Gradient kind, const Masks& masks,
                               const Eigen::VectorXd& level = {});

/// Computes the weights α_i of the pairs of water particle i with layers of a body (F22),
///   α_i = Σ_water w (r_ij·n)/r² / −Σ_body w (r_ij·n)/r² ,   n the face's normal,
/// so that a uniform pressure moves nothing along n. Without them the symmetric form pushes a particle off a
/// face, or draws it to it, where its distance to the first layer is not l0, in proportion to the pressure.
/// In an impact a distance wrong by 3 % makes a velocity as large as the plate's. The weight belongs to the
/// pair: the body feels the same factor, and momentum stays exact. It is 1 away from bodies, and where the
/// water behind the particle is thin (spray). It lies within 0.5 … 2. Plane bodies alone; in space all
/// weights are 1.
template <int dim>
Eigen::VectorXd face_level(const State<dim>&, const Boundary<dim>&, const Neighbours& near,
                           const LatticeConstants& lattice, double spacing);

/// Moves particles towards even spacing (fluid/THEORY.md, section 8.8):
///   δr_i = −A (|u_i| + U) Δt l0 ∇C_i, ∇C_i = (d/n0) Σ_j w r_ij/r², at most 0.1 l0,
/// with U = √(g l0), the fall over one spacing. At the surface the component along the surface normal (the
/// direction of ∇C) is left out, which leaves nothing of ∇C itself. There the particle follows the mean shift
/// of its inner neighbours along the surface. A: scheme.shifting; 0 shifts nothing.
template <int dim>
void shift_particles(State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                     const LatticeConstants& lattice, double strength, double rest_speed, double dt,
                     double spacing);

}  // namespace strake::fluid
