#pragma once

#include "structure/body/parameters.hpp"
#include "structure/fem/mesh/mesh.hpp"
#include "structure/material/material.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <vector>

namespace strake::structure::fem {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Integrals over the cells, total Lagrangian: everything refers to the reference configuration X.
///
///   F = I + ∇u,  E = ½(FᵀF − I),  S(E) and ψ(E) of material.hpp;  linear: F = I and E = ½(∇u + ∇uᵀ)
///
/// Vectors have u [m] in unknown dim·node + component.
template <int dim>
class Assembly {
 public:
  /// From here on a material counts as one that keeps its volume: there Q2 cells lock too.
  static constexpr double incompressible = 0.49;  // Poisson's ratio

  /// One material per part of the solid. Enhanced: cells add strains to those of their displacement
  /// (enhanced.hpp); automatic: Q1, and Q2 where the material keeps its volume, but no neo-Hookean ones:
  /// where those double their volume, the minimum that the strains are is beside a saddle. Solid shell: cells
  /// that have a thin direction are of solid_shell.hpp, the others enhanced.
  Assembly(const Mesh<dim>&, const std::vector<Part>&, StrainField = StrainField::automatic);

  /// Internal nodal forces [N] between two configurations u0 and u1, for a step weighted α to its start:
  ///   f_a = ∫ F_α S_α ∇N_a dV,  F_α = F(α u0 + (1−α) u1),  S_α of E_α = α E(u0) + (1−α) E(u1).
  /// With α = ½ the work f·(u1 − u0) is exactly the change of strain energy, also for large deformation,
  /// since F_½ᵀ ∇(u1 − u0) has the symmetric part ΔE = E1 − E0 (Simo & Tarnow 1992): for a quadratic ψ as it
  /// stands, for neo-Hookean with a multiple of ΔE added to S_½ that makes up the cell's work (Gonzalez
  /// 2000). u0 = u1 gives the static force.
  Eigen::VectorXd internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const;

  /// ∂f/∂u1 of the above, divided by 1−α: the tangent stiffness [N/m] for u0 = u1, then symmetric.
  Matrix tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const;
  Matrix tangent(const Eigen::VectorXd& u) const { return tangent(u, u, 0); }

  /// ∫ ψ dV [J].
  double strain_energy(const Eigen::VectorXd& u) const;

  /// Smallest det F in the quadrature points; for linear elasticity 1.
  double smallest_jacobian(const Eigen::VectorXd& u) const;

  /// Consistent mass ∫ ρ N_a N_b dV [kg] on each component.
  Matrix mass() const;

  /// State in the quadrature points of a cell, n_state × n. Components: Cauchy stress xx, xy, xz, yy, yz, zz
  /// [Pa], then strain energy per reference volume [J/m³].
  static constexpr int n_state = 7;
  Eigen::MatrixXd cell_state(const Eigen::VectorXd& u, int cell) const;

  bool is_enhanced(int cell) const {
    return enhanced_[static_cast<std::size_t>(mesh_.part[static_cast<std::size_t>(cell)])] != 0;
  }
  /// The axis of a cell that is a solid shell, −1 for all others.
  int thin_axis(int cell) const { return thin_.empty() ? -1 : thin_[static_cast<std::size_t>(cell)]; }
  /// How many cells are solid shells, of all ranks.
  int shells() const;
  bool any_enhanced() const { return std::find(enhanced_.begin(), enhanced_.end(), 1) != enhanced_.end(); }

  const Material& material(int cell) const {
    return part_[static_cast<std::size_t>(mesh_.part[static_cast<std::size_t>(cell)])].material;
  }

  /// Share of its stress that each cell still carries; for compatible strains. At 0 a cell keeps `residual`
  /// of its stiffness, linear: it may turn and close without F to be turned inside out.
  void damage(Eigen::VectorXd integrity);
  bool intact() const { return integrity_.size() == 0 || integrity_.minCoeff() == 1; }
  static constexpr double residual = 1e-5;
  double share(int cell) const {
    return integrity_.size() == 0 ? 1 : integrity_(cell) == 0 ? residual : integrity_(cell);
  }

 private:
  /// Sum of the cells' matrices, which `compute(c, matrix)` makes of the sample (cell_sums.hpp).
  template <class Local, class Compute>
  Matrix scatter(const Local& sample, const Compute& compute) const;
  /// Calls `use` with the element of a cell, of `n` nodes, and its material (cell_sums.hpp).
  template <int n, class Use>
  decltype(auto) with_element(int cell, const Use& use) const;

  const Mesh<dim>& mesh_;
  bool eroded(int cell) const { return integrity_.size() > 0 && integrity_(cell) == 0; }
  const Material& of(int cell) const {
    if (eroded(cell)) return eroded_[static_cast<std::size_t>(mesh_.part[static_cast<std::size_t>(cell)])];
    return material(cell);
  }
  std::vector<Part> part_;
  std::vector<Material> eroded_;  // of the parts: linear
  std::vector<char> enhanced_;    // of the parts
  std::vector<int> thin_;         // of the cells, see thin_axis; empty: no solid shells
  Eigen::VectorXd integrity_;     // empty: intact
  Matrix pattern_;                // of zeros
};

}  // namespace strake::structure::fem
