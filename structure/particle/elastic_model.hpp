#pragma once

#include <Eigen/Core>

namespace strake::structure {

/// Internal forces of a particle body: what total Lagrangian and pair model have in common.
class ElasticModel {
 public:
  virtual ~ElasticModel() = default;
  /// 2×n [N/m] per metre of depth, from the displacement 2×n [m].
  virtual Eigen::Matrix2Xd force(const Eigen::Matrix2Xd& displacement) const = 0;
  /// Strain energy [J/m].
  virtual double energy(const Eigen::Matrix2Xd& displacement) const = 0;
  /// Particles further apart than this many spacings have no influence on one another's force.
  virtual int influence() const = 0;
};

}  // namespace strake::structure
