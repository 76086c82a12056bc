#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>

namespace strake::fluid {

/// The role of a particle in the pressure equation.
enum class Row : std::uint8_t {
  none,  // no unknown and not in the Laplacian: dummies, removed particles, the inside of a particle solid
  zero,  // free surface, dry wall: P = 0
  unknown,
};

/// The data of the equation, one entry per particle.
struct PressureTerms {
  std::span<const Row> row;
  const Eigen::VectorXd& divergence;     // ∇·u* [1/s]
  const Eigen::VectorXd& deviation;      // (n − n0)/n0, already clipped where the surface is near
  const Eigen::VectorXd& old_pressure;   // pⁿ [Pa]
  const Eigen::VectorXd& solid_density;  // ρ_i of the last particles, the structure's [kg/m³]
  double reference_density = 1000;       // ρ of the water
  double sound_speed = 1500;             // c [m/s]; infinity: incompressible
  double dt = 0;                         // Δt [s]
};

/// γ of fluid/THEORY.md (F29) for one step: Δt/τ where a time constant is given.
double drift_factor(const Scheme&, double dt);

/// Assembles fluid/THEORY.md (F27) or (F29), weakly compressible, one row per unknown i:
///   Σ_j β_ij w_ij (p_i − p_j) + s p_i/(c²Δt²) = −s ρ f_i ,   s = n0 λ/(2d)
///   divergence  f = ∇·u*/Δt − pⁿ/(ρc²Δt²)
///   mixed       f = (1−γ) ∇·u*/Δt − pⁿ/(ρc²Δt²) − (γ/Δt²)(δ − pⁿ/(ρc²))
/// with δ = (n − n0)/n0, n at r* or r^k. Between structure particles β = 2ρ/(ρ_i+ρ_j), which is their
/// inertia. β is 1 where one of the two is water: a structure's outer layer acts as a wall layer, with the
/// pressure of the water on it. (With the mean density between water and structure as well, a heavy layer
/// loses contact with the water and its own ∇·u* drives its pressure without bound.) `system` is passed in so
/// that its memory is used again.
template <int dim>
void assemble_pressure(const Neighbours&, const PressureTerms&, const Scheme&,
                       const LatticeConstants& laplacian, PressureSystem& system);

}  // namespace strake::fluid
