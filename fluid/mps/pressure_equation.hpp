#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// What a particle is to the pressure equation.
enum class Row : std::uint8_t {
  none,  // no unknown and not in the Laplacian: dummies, parked particles, the inside of a particle solid
  zero,  // free surface, dry wall: P = 0
  unknown,
};

/// A p = b, symmetric positive definite: the pressure equation times −ρ n0 λ / (2d), ρ the water's density.
/// Off-diagonal entries of row k: column[start[k]] … column[stop[k] − 1], sorted; room behind stop[k] is
/// unused. They are numbers of single precision, since a weight's seventh digit says nothing and a product is
/// as fast as its entries are read; the diagonal holds their exact sum, so that a row has no other error. The
/// views are of `own`, or of whoever has the same rows already (then valid as long as those).
struct PressureSystem {
  std::vector<std::int32_t> particle;  // of the unknown
  std::span<const std::int64_t> start, stop;
  std::span<const std::int32_t> column;
  std::span<const float> value;
  Eigen::VectorXd diagonal, right;
  struct {
    std::vector<std::int32_t> unknown_of;  // of the particle, −1: none
    std::vector<std::int64_t> start, stop;
    std::vector<std::int32_t> column;
    std::vector<float> value;
  } own;

  PressureSystem() = default;
  PressureSystem(PressureSystem&&) = default;
  PressureSystem& operator=(PressureSystem&&) = default;
  PressureSystem(const PressureSystem&) = delete;
  PressureSystem& operator=(const PressureSystem&) = delete;
  std::int64_t size() const { return static_cast<std::int64_t>(particle.size()); }
};

/// What the equation is made of, one entry per particle.
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

/// fluid/THEORY.md (F26)–(F29), weakly compressible, one row per unknown i:
///   Σ_j β_ij w_ij (p_i − p_j) + s p_i/(c²Δt²) = −s ρ f_i ,   s = n0 λ/(2d)
///   density     f = −δ/Δt²                              (δ = (n − n0)/n0, n at r* or r^k)
///   divergence  f = ∇·u*/Δt − pⁿ/(ρc²Δt²)
///   mixed       f = (1−γ) ∇·u*/Δt − pⁿ/(ρc²Δt²) − (γ/Δt²)(δ − pⁿ/(ρc²))
/// β = 2ρ/(ρ_i+ρ_j) between structure particles, which is their inertia, and 1 where one of the two is water:
/// a structure's outer row is a wall row, its pressure is that of the water on it. (With the mean density
/// between water and structure as well, a heavy row loses touch with the water and its own ∇·u* drives its
/// pressure without bound.) `system` is passed in so that its memory is used again.
template <int dim>
void assemble_pressure(const Neighbours&, const PressureTerms&, const Scheme&,
                       const LatticeConstants& laplacian, PressureSystem& system);

/// Gives each block of unknowns that touches no P = 0 particle one: only c = ∞ leaves the pressure of such a
/// block open. Its right side is made compatible (mean removed) and its first unknown pinned. Returns the
/// number of blocks.
int close_sealed_blocks(PressureSystem&);

struct PressureSolution {
  Eigen::VectorXd pressure;  // one per unknown [Pa]
  int iterations = 0;
  double residual = 0;  // ‖b − A p‖₂ / ‖b‖₂
};

/// ‖b − A p‖₂ / ‖b‖₂.
double pressure_residual(const PressureSystem&, const Eigen::VectorXd& pressure);

}  // namespace strake::fluid
