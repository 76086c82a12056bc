#pragma once

#include "structure/parameters.hpp"
#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"

namespace strake::structure {

/// Corrected total-Lagrangian particles with hourglass energy (PHYSICS §6): the force is the exact negative
/// gradient of
///   U = Σ_i V ψ(F_i) + ½ Σ_i κ_i Σ_j w⁰_ij |e_ij|²,   e_ij = r_ij − F_i r⁰_ij,   κ_i = α E V / Σ_k w⁰_ik
///   |r⁰_ik|²
/// so that linear momentum, angular momentum and energy are kept. References: Suzuki & Koshizuka 2008
/// (Hamiltonian MPS); the hourglass form is derived in PHYSICS §6.
class TotalLagrangian final : public ElasticModel {
 public:
  TotalLagrangian(const Material&, const Bonds&, double volume /* [m²] */, double hourglass);
  Eigen::Matrix2Xd force(const Eigen::Matrix2Xd& displacement) const override;
  double energy(const Eigen::Matrix2Xd& displacement) const override;
  int influence() const override { return influence_; }

 private:
  Material material_;
  const Bonds& bonds_;
  double volume_;            // V [m²] per metre of depth
  Eigen::VectorXd penalty_;  // κ_i [Pa]
  int influence_;
};

}  // namespace strake::structure
