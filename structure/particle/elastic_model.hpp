#pragma once

#include "structure/particle/lattice.hpp"

#include <Eigen/Core>

namespace strake::structure {

/// Internal forces of a particle body: what total Lagrangian and pair model have in common.
template <int dim>
class ElasticModel {
 public:
  virtual ~ElasticModel() = default;
  /// dim×n [N] (per metre of depth in two dimensions), from the displacement dim×n [m].
  virtual Vectors<dim> force(const Vectors<dim>& displacement) const = 0;
  /// Strain energy [J] ([J/m]).
  virtual double energy(const Vectors<dim>& displacement) const = 0;
  /// Particles further apart than this many spacings have no influence on one another's force.
  virtual int influence() const = 0;

  /// Whether each particle turns as an unknown of its own, with the moment of inertia m l0²/6 of a square.
  virtual bool spins() const { return false; }
  /// The same with the turn θ [rad] of each particle; its torque [N m/m] comes back.
  virtual Vectors<dim> force(const Vectors<dim>& displacement, const Eigen::VectorXd& /* turn */,
                             Eigen::VectorXd& /* torque */) const {
    return force(displacement);
  }
  virtual double energy(const Vectors<dim>& displacement, const Eigen::VectorXd& /* turn */) const {
    return energy(displacement);
  }
};

}  // namespace strake::structure
