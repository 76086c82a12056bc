#pragma once

#include "structure/parameters.hpp"
#include "structure/particle/bonds.hpp"
#include "structure/particle/elastic_model.hpp"

namespace strake::structure {

/// The paper's elastic particles, eqs (37)-(44) of PHYSICS §6: normal and shear springs along each bond and a
/// pressure from the volumetric strain. The rotation θ_i is that of the neighbourhood (form R1), normalised
/// by the particle's own n_i; stresses are normalised by n0. Linear momentum is exact. For small strains the
/// forces are the gradient of `energy`, so that energy and angular momentum are kept too; at finite strain
/// only nearly, since R1 leaves out what θ itself contributes.
class PairModel final : public ElasticModel {
 public:
  PairModel(const Material&, const Bonds&, double volume /* [m²] */);
  Eigen::Matrix2Xd force(const Eigen::Matrix2Xd& displacement) const override;
  double energy(const Eigen::Matrix2Xd& displacement) const override;
  int influence() const override { return influence_; }

 private:
  struct Kinematics {
    Eigen::Matrix2Xd half_turn;  // 2×n cos(θ/2), sin(θ/2)
    Eigen::VectorXd trace;       // n ε_rr
  };
  Kinematics kinematics(const Eigen::Matrix2Xd& displacement) const;

  Material material_;
  const Bonds& bonds_;
  double volume_;  // V [m²] per metre of depth
  int influence_;
};

}  // namespace strake::structure
