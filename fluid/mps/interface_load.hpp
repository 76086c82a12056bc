#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/scheme/fluid_scheme.hpp"

#include <Eigen/Core>

namespace strake::fluid {

/// The data from which the load is computed.
template <int dim>
struct LoadTerms {
  const Vectors<dim>& viscous;  // ν∇²u + ∇·τ at every layer [m/s²]; times the particle mass the force on it
  const Vector<dim>& gravity;       // g of this step [m/s²]
  const Points& acceleration;       // of the interface points [m/s²], 3×m or empty
  Gradient gradient;                // of the corrector
  const LatticeConstants& lattice;  // of the gradient
  double density, spacing;
  const Eigen::VectorXd* level = nullptr;  // `face_level` of the water that the gradient was made with
};

/// Computes pressure and viscous force on the layers of tank and bodies (fluid/THEORY.md (F58), (F59)).
///   pairwise  reaction of the pair forces: f_j = −V (d/n0) Σ_water α_i (P_i+P_j) r_ji w/r²
///   else      f = −p n A on first layers, p at the face: P_w + ρ (g − a_w)·(r_face − r_w); dry ones: 0
/// Structure particles of volume coupling have the pair forces with every gradient. Viscous and SPS forces
/// are pair reactions in all cases. state.pressure has the values of the dummies.
template <int dim>
LayerForces<dim> layer_forces(const State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                              const LoadTerms<dim>&);

/// Computes the pressure of the pairs of water and each structure particle in volume coupling, 2×particles.
/// The rows are Σ ½ (P_i + P_j) w over the water in reach [Pa], and Σ w. The pairwise force fixes only
/// P_i + P_j. The division of the sum between the two is undetermined and drifts, so sensors average the
/// pair.
template <int dim>
Eigen::Matrix2Xd carried_pressure(const State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                                  const LatticeConstants& lattice);

/// Sums the forces of the layer particles on each of the boundary's `points` [N].
template <int dim>
Vectors<dim> gather_on_points(const LayerForces<dim>&, const Boundary<dim>&);

/// Computes the momentum that no impulse accounts for [N s]: water − initial − gravity + bodies + tank. It is
/// round-off for the pairwise gradient, a measured number for the others.
template <int dim>
Vector<dim> momentum_gap(const State<dim>& state, double particle_mass, const RankExchange<dim>& = {});

}  // namespace strake::fluid
