#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/scheme/fluid_scheme.hpp"

#include <Eigen/Core>

#include <span>

namespace strake::fluid {

/// What the load is made of.
template <int dim>
struct LoadTerms {
  const Vectors<dim>& viscous;  // ν∇²u + ∇·τ at every row [m/s²], times the particle mass the reaction on it
  const Vector<dim>& gravity;       // g of this step [m/s²]
  const Points& acceleration;       // of the interface points [m/s²], 3×m or empty
  Gradient gradient;                // of the corrector
  const LatticeConstants& lattice;  // of the gradient
  double density, spacing;
  const Eigen::VectorXd* level = nullptr;  // `face_level` of the water that the gradient was made with
};

/// Pressure and viscous force on the rows of tank and bodies (fluid/THEORY.md (F58), (F59)).
///   pairwise  reaction of the pair forces that move the water: f_j = −V (d/n0) Σ_water (P_i+P_j) r_ji w/r²
///   else      f = −p n A on first rows, p at the face: P_w + ρ (g − a_w)·(r_face − r_w); dry rows: 0
/// Viscous and SPS forces are pair reactions in all cases. state.pressure holds the dummies' values.
template <int dim>
LayerForces<dim> layer_forces(const State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                              const LoadTerms<dim>&);

/// Pressure of the pairs of water and each structure's particle in volume coupling: Σ ½ (P_i + P_j) w over
/// the water in reach [Pa] and Σ w, 2×particles. The pairwise force fixes only P_i + P_j. How the sum is
/// split between the two is undetermined and drifts, so sensors average the pair.
template <int dim>
Eigen::Matrix2Xd carried_pressure(const State<dim>& state, const Boundary<dim>&, const Neighbours& near,
                                  const LatticeConstants& lattice);

/// Sum of row forces on each of the boundary's `points` [N].
template <int dim>
Vectors<dim> gather_on_points(const LayerForces<dim>&, const Boundary<dim>&);

/// Momentum that is not accounted for, [N s]: water − initial − gravity + bodies + tank. Round-off for the
/// pairwise gradient, a measured number for the others.
template <int dim>
Vector<dim> momentum_gap(const State<dim>& state, double particle_mass);

}  // namespace strake::fluid
