#pragma once

#include "fluid/particles/kernel.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Masks of the particles: rows that are computed (the others are zero) and columns that are summed. An empty
/// span includes all particles; otherwise there is one byte per particle, non-zero where it is included.
struct Masks {
  std::span<const std::uint8_t> row, column;
};
template <int dim>
using Tensor = Eigen::Matrix<double, dim, dim>;

/// `rows` may reach farther than `lattice.radius` in all of these; pairs beyond it do not count. Notation:
/// r_ij = r_j − r_i, w = r_e/r − 1, d = dim, n0 and λ of `lattice`. Units: those of φ per m, or per m².

/// Computes (d/n0) Σ_j (φ_j − φ̂_i) r_ij w/r² (fluid/THEORY.md (F16)). φ̂_i is the smallest φ of i and its
/// included neighbours.
template <int dim>
Vectors<dim> gradient_min_pressure(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                                   const Neighbours& rows, const LatticeConstants& lattice,
                                   const Masks& = {});
/// (d/n0) Σ_j (φ_j + φ_i) r_ij w/r²: antisymmetric in i and j, so momentum is exact (fluid/THEORY.md (F19)).
template <int dim>
Vectors<dim> gradient_pairwise(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                               const Neighbours& rows, const LatticeConstants& lattice, const Masks& = {});
/// C_i (d/n0) Σ_j (φ_j − φ_i) r_ij w/r²: exact for linear φ where C is not the identity (fluid/THEORY.md
/// (F20)).
template <int dim>
Vectors<dim> gradient_corrected(const Vectors<dim>& position, const Eigen::VectorXd& phi,
                                const Neighbours& rows, const LatticeConstants& lattice,
                                std::span<const Tensor<dim>> correction, const Masks& = {});
/// C_i = [(d/n0) Σ_j w r⊗r/r²]⁻¹, or the identity where that matrix is nearly singular (det < 0.05 or cond >
/// 20: surface, splash).
template <int dim>
std::vector<Tensor<dim>> gradient_correction(const Vectors<dim>& position, const Neighbours& rows,
                                             const LatticeConstants& lattice, const Masks& = {});

/// (d/n0) Σ_j (u_j − u_i)·r_ij w/r² (fluid/THEORY.md (F17)).
template <int dim>
Eigen::VectorXd divergence(const Vectors<dim>& position, const Vectors<dim>& velocity, const Neighbours& rows,
                           const LatticeConstants& lattice, const Masks& = {});
/// ∂u_l/∂x_m = (d/n0) Σ_j (u_j − u_i)_l (r_ij)_m w/r², times C_i from the right when `correction` is given.
template <int dim>
std::vector<Tensor<dim>> velocity_gradient(const Vectors<dim>& position, const Vectors<dim>& velocity,
                                           const Neighbours& rows, const LatticeConstants& lattice,
                                           std::span<const Tensor<dim>> correction = {}, const Masks& = {});

/// (2d/(n0 λ)) Σ_j (φ_j − φ_i) w (fluid/THEORY.md (F18)).
template <int dim>
Eigen::VectorXd laplacian(const Eigen::VectorXd& phi, const Neighbours& rows, const LatticeConstants& lattice,
                          const Masks& = {});
template <int dim>
Vectors<dim> laplacian(const Vectors<dim>& u, const Neighbours& rows, const LatticeConstants& lattice,
                       const Masks& = {});

/// Computes the conservative stress form (d/n0) Σ_j (τ_i + τ_j)·r_ij w/r² (the first part of fluid/THEORY.md
/// (F12)). It is antisymmetric.
template <int dim>
Vectors<dim> stress_divergence(const Vectors<dim>& position, std::span<const Tensor<dim>> tau,
                               const Neighbours& rows, const LatticeConstants& lattice, const Masks& = {});

}  // namespace strake::fluid
