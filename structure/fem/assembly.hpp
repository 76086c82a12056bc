#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "structure/fem/mesh.hpp"
#include "structure/parameters.hpp"

namespace strake::structure::fem {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Integrals over the cells, total Lagrangian: everything refers to the reference configuration X.
///
///   F = I + ∇u,  E = ½(FᵀF − I),  S = λ tr(E) I + 2μ E,  ψ = ½ S:E            (Saint Venant–Kirchhoff)
///   linear: F = I and E = ½(∇u + ∇uᵀ)
///
/// Plane strain is dim = 2 with the λ of three dimensions. Vectors hold u [m] in unknown dim·node +
/// component.
template <int dim>
class Assembly {
 public:
  Assembly(const Mesh<dim>&, const Material&);

  /// Internal nodal forces [N] between two configurations u0 and u1, for a step weighted α to its start:
  ///   f_a = ∫ F_α S_α ∇N_a dV,  F_α = F(α u0 + (1−α) u1),  S_α = α S(u0) + (1−α) S(u1).
  /// With α = ½ the work f·(u1 − u0) is exactly the change of strain energy, also for large deformation,
  /// since F_½ᵀ ∇(u1 − u0) has the symmetric part E1 − E0 (Simo & Tarnow 1992). u0 = u1 gives the static
  /// force.
  Eigen::VectorXd internal_force(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const;

  /// ∂f/∂u1 of the above, divided by 1−α: the tangent stiffness [N/m] for u0 = u1, then symmetric.
  Matrix tangent(const Eigen::VectorXd& u0, const Eigen::VectorXd& u1, double alpha) const;
  Matrix tangent(const Eigen::VectorXd& u) const { return tangent(u, u, 0); }

  /// ∫ ψ dV [J].
  double strain_energy(const Eigen::VectorXd& u) const;

  /// Smallest det F in the quadrature points; 1 for linear elasticity, which knows no F.
  double smallest_jacobian(const Eigen::VectorXd& u) const;

  /// Consistent mass ∫ ρ N_a N_b dV [kg] on each component.
  Matrix mass() const;

  /// Von Mises stress [Pa] of the Cauchy stress F S Fᵀ / det F in the nodes, mean over the cells that meet
  /// there.
  Eigen::VectorXd von_mises(const Eigen::VectorXd& u) const;

 private:
  template <class Visit>
  Matrix scatter(const Visit& cell_matrix) const;

  const Mesh<dim>& mesh_;
  double lambda_ = 0, mu_ = 0, density_ = 0;  // [Pa], [Pa], [kg/m^3]
  bool large_ = true;                         // finite deformation
  Matrix pattern_;
  std::vector<int> slot_;  // per cell and node pair: where in the row of node a the columns of node b begin
};

}  // namespace strake::structure::fem
