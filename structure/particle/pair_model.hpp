#pragma once

#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"

namespace strake::structure {

/// The paper's elastic particles, structure/THEORY.md (S23)–(S28): normal and shear springs along each bond
/// and a pressure from the volumetric strain. Stresses are normalised by n0. Linear momentum is exact. Two
/// dimensions. Rotation θ_i:
///   kinematic (R1)  that of the neighbourhood, normalised by the particle's own n_i. For small strains the
///                   forces are the gradient of `energy`, so that energy and angular momentum are kept too;
///                   at finite strain only nearly, since R1 leaves out what θ itself contributes.
///   dynamic (R2)    an unknown of its own, I dω_i/dt = ½ Σ_j r_ij × F^τ_ij: angular momentum with the
///                   spins' own is exact at any strain.
class PairModel final : public ElasticModel<2> {
 public:
  PairModel(const Lattice<2>&, const Bonds<2>&, Rotation = Rotation::kinematic);
  Eigen::Matrix2Xd force(const Eigen::Matrix2Xd& displacement) const override;
  double energy(const Eigen::Matrix2Xd& displacement) const override;
  int influence() const override { return influence_; }
  bool spins() const override { return rotation_ == Rotation::dynamic; }
  Vectors<2> force(const Vectors<2>& displacement, const Eigen::VectorXd& turn,
                   Eigen::VectorXd& torque) const override;
  double energy(const Vectors<2>& displacement, const Eigen::VectorXd& turn) const override;

 private:
  struct Kinematics {
    Eigen::Matrix2Xd half_turn;  // 2×n cos(θ/2), sin(θ/2)
    Eigen::VectorXd trace;       // n ε_rr
  };
  Eigen::Matrix2Xd turn_of_neighbours(const Eigen::Matrix2Xd& displacement) const;
  Kinematics kinematics(const Eigen::Matrix2Xd& displacement, Eigen::Matrix2Xd half_turn) const;
  Vectors<2> force(const Eigen::Matrix2Xd& displacement, const Kinematics&, Eigen::VectorXd* torque) const;
  double bond_energy(const Eigen::Matrix2Xd& displacement, const Kinematics&, double bending) const;

  const Bonds<2>& bonds_;
  double volume_;                    // V [m²] per metre of depth
  double lambda_;                    // λ_s [Pa] of the first particle, 1 where it has none
  Eigen::VectorXd relative_lambda_;  // n λ_s over that
  Eigen::VectorXd mu_;               // m μ_s of each bond [Pa]; between two materials it is that of both in
                                     // series
  Rotation rotation_;
  int influence_;
};

}  // namespace strake::structure
