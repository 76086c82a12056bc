#pragma once

#include <Eigen/Core>
#include <vector>

#include "fluid/operators.hpp"
#include "fluid/parameters.hpp"

namespace strake::fluid {

/// The sub-particle-scale model in local equilibrium (PHYSICS §1): production = dissipation.
struct SpsModel {
  double c_nu = 0.08, c_eps = 1.0;  // ν_t = C_ν Δ k^½, ε = C_ε k^{3/2}/Δ
  double filter = 0;                // Δ [m], the particle spacing
  double kinematic_viscosity = 0;   // ν [m²/s], for y⁺
  bool wall_damping = false;        // van Driest
  double cs() const;                // C_s = (C_ν³/C_ε)^¼ (8)
};

/// What the model knows of each particle.
struct SpsFields {
  Eigen::VectorXd production;      // Pr = 2 S_lm S_lm [1/s²] (11)
  Eigen::VectorXd k;               // (C_ν/C_ε) Δ² Pr [m²/s²] (12)
  Eigen::VectorXd eddy_viscosity;  // ν_t = (C_s Δ)² Pr^½ [m²/s] (10); 0 with fewer than 4 neighbours
};
/// Pr = 2 S:S of one velocity gradient [1/s²].
template <int dim>
double production(const Tensor<dim>& velocity_gradient);

/// counts: neighbours of each particle. wall_distance: [m] per particle, only read with wall damping (may be
/// empty without it). Particles whose row mask is zero get zeros.
template <int dim>
SpsFields sps_fields(std::span<const Tensor<dim>> velocity_gradient, std::span<const std::int32_t> counts,
                     const SpsModel&, const Eigen::VectorXd& wall_distance = {}, const Masks& = {});

/// ⟨∇·τ⟩ [m/s²], τ = 2 ν_t S − (2/3) k I (9). `stress_pair`: the antisymmetric sum of operators.hpp, without
/// ν∇²u.
template <int dim>
Vectors<dim> sps_acceleration(const Vectors<dim>& position, std::span<const Tensor<dim>> velocity_gradient,
                              const SpsFields&, const Neighbours& rows,
                              const LatticeConstants& gradient_lattice, const Masks& = {});

/// `laplacian`: Σ ν_ij (u_j − u_i) w … + (∇u)ᵀ·∇ν_t − (2/3)∇k [m/s²]. Contains ν as well: the explicit stage
/// then adds no ν∇²u of its own.
template <int dim>
Vectors<dim> sps_acceleration_laplacian(const Vectors<dim>& position, const Vectors<dim>& velocity,
                                        std::span<const Tensor<dim>> velocity_gradient, const SpsFields&,
                                        const SpsModel&, const Neighbours& rows,
                                        const LatticeConstants& gradient_lattice,
                                        const LatticeConstants& laplacian_lattice, const Masks& = {});

/// All of it: the acceleration by ν and the SPS model as the scheme asks for it, and k and ν_t for the State.
/// The predictor calls this once per step. near: rows of at least radius_gradient, far: of radius_laplacian.
template <int dim>
struct ViscousStage {
  Vectors<dim> acceleration;  // ν∇²u + ∇·τ [m/s²]
  SpsFields sps;              // empty vectors without a model
};
template <int dim>
ViscousStage<dim> viscous_stage(const Vectors<dim>& position, const Vectors<dim>& velocity, const Parameters&,
                                const Neighbours& near, const Neighbours& far, const Masks& = {},
                                const Eigen::VectorXd& wall_distance = {});

}  // namespace strake::fluid
