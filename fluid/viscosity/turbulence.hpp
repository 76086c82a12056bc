#pragma once

#include "fluid/mps/operators.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/viscosity/viscous_walls.hpp"

#include <Eigen/Core>

#include <cmath>
#include <span>

namespace strake::fluid {

/// The sub-particle-scale model (fluid/THEORY.md (F4)–(F10)): ν_t = C_ν Δ k^½, ε = C_ε k^{3/2}/Δ, Pr = 2 S:S.
struct SpsModel {
  double c_nu = 0.08, c_eps = 1.0;
  double filter = 0;               // Δ [m], the particle spacing
  double kinematic_viscosity = 0;  // ν [m²/s]
  bool wall_damping = false;       // van Driest

  double cs() const;  // C_s = (C_ν³/C_ε)^¼ (F7)
  /// Returns k [m²/s²] where production equals dissipation, (F6); ν_t is then (C_s Δ)² Pr^½ (F7).
  double equilibrium(double production) const { return c_nu / c_eps * filter * filter * production; }
  double eddy_viscosity(double k) const { return c_nu * filter * std::sqrt(k); }  // [m²/s]
  /// Returns the factor of ν_t at that distance from a wall [m]:
  ///   (1 − exp(−y⁺/26))², y⁺ = y u_τ/ν.
  /// The friction velocity is that of the local shear, u_τ² = ν Pr^½. Damping acts on the length C_s Δ, so on
  /// ν_t with its square.
  double damping(double distance, double production) const;
};
SpsModel sps_model(const Parameters&);

/// Returns the largest time step of the explicit viscous terms, 0.125 l0²/(ν + ν_t) [s]. The sum `joint` is
/// stable to 0.5 l0²/ν on the lattice, less beside walls.
double viscous_limit(const Parameters&, double largest_k);

/// Advances k by one step of its transport equation, on the water:
///   Dk/Dt = ν_t Pr − C_ε k^{3/2}/Δ + ∇·((ν + ν_t/σ_k)∇k), σ_k = 1.
/// With q = k^½ the first two terms are dq/dt = a − b q², a = ½ C_ν Δ Pr, b = ½ C_ε/Δ. The step is
///   q ← (q + a Δt)/(1 + b q Δt).
/// It is positive for any Δt, and at rest in the equilibrium of the static closure. Where nothing shears it
/// is the exact q = q0/(1 + b q0 t). Unlike k itself q grows from zero. Diffusion follows, a pair Laplacian
/// whose own share is implicit: positive for any Δt too. k is zero on faces that are not smooth. There is no
/// flux through smooth faces, nor through the free surface, where no pairs are. eddy_viscosity: before the
/// step.
template <int dim>
void advance_k(const ViscousFlow<dim>&, const SpsModel&, const LatticeConstants&,
               const Eigen::VectorXd& production, const Eigen::VectorXd& eddy_viscosity, double dt,
               Eigen::VectorXd& k, Eigen::VectorXd& scratch);

/// Number of neighbours below which a particle is spray: it has no eddy viscosity (fluid/THEORY.md, section
/// 2).
inline constexpr int fewest_neighbours = 4;

/// The static model's values at each particle.
struct SpsFields {
  Eigen::VectorXd production;      // Pr = 2 S_lm S_lm [1/s²] (F5)
  Eigen::VectorXd k;               // (C_ν/C_ε) Δ² Pr [m²/s²] (F6)
  Eigen::VectorXd eddy_viscosity;  // ν_t = (C_s Δ)² Pr^½ [m²/s] (F7); 0 with fewer than 4 neighbours
};
/// Pr = 2 S:S of one velocity gradient [1/s²].
template <int dim>
double production(const Tensor<dim>& velocity_gradient);

/// Computes the static model's values at each particle. counts: neighbours of each particle. wall_distance:
/// [m] of the water, only read with wall damping; the layers behind it lie at the wall. Particles whose row
/// mask is zero get zeros.
template <int dim>
SpsFields sps_fields(std::span<const Tensor<dim>> velocity_gradient, std::span<const std::int32_t> counts,
                     const SpsModel&, std::span<const double> wall_distance = {}, const Masks& = {});

/// Advances k as `advance_k` does, with the production of these fields, and sets their k and ν_t.
template <int dim>
void advance_fields(const ViscousFlow<dim>&, const SpsModel&, const LatticeConstants&,
                    std::span<const std::int32_t> counts, double dt, Eigen::VectorXd& k,
                    Eigen::VectorXd& scratch, SpsFields&);

/// Computes ⟨∇·τ⟩ [m/s²], τ = 2 ν_t S − (2/3) k I (F3). It is the form `stress_pair`: the antisymmetric sum
/// of operators.hpp, without ν∇²u.
template <int dim>
Vectors<dim> sps_acceleration(const Vectors<dim>& position, std::span<const Tensor<dim>> velocity_gradient,
                              const SpsFields&, const Neighbours& rows,
                              const LatticeConstants& gradient_lattice, const Masks& = {});

}  // namespace strake::fluid
