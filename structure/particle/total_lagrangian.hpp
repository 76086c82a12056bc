#pragma once

#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"

namespace strake::structure {

/// Corrected total-Lagrangian particles with hourglass energy (structure/THEORY.md (S19)–(S22)): the force is
/// the exact negative gradient of
///   U = Σ_i V ψ(F_i) + ½ Σ_i κ_i Σ_j w⁰_ij |e_ij|²,   e_ij = r_ij − F_i r⁰_ij,   κ_i = α E V
///   (dim/2) / Σ_k w⁰_ik |r⁰_ik|²
/// (the sum grows with the number of dimensions: dim/2 keeps what a given α does to a bond of the plane), so
/// that linear momentum, angular momentum and energy are kept, across parts of different materials too.
/// A particle that softens keeps Bonds::integrity of its whole energy. References: Suzuki & Koshizuka 2008
/// (Hamiltonian MPS); the hourglass form is derived in structure/THEORY.md, section 5.1.
template <int dim>
class TotalLagrangian final : public ElasticModel<dim> {
 public:
  TotalLagrangian(const Lattice<dim>&, const Bonds<dim>&, double hourglass);
  Vectors<dim> force(const Vectors<dim>& displacement) const override;
  double energy(const Vectors<dim>& displacement) const override;
  int influence() const override { return influence_; }

 private:
  Eigen::VectorXd penalties() const;

  const Lattice<dim>& lattice_;
  const Bonds<dim>& bonds_;
  Eigen::VectorXd stiffness_;  // α E_i V [N]
  int influence_;
};

}  // namespace strake::structure
