#pragma once

#include "structure/particle/lattice.hpp"

#include <Eigen/SparseCholesky>

#include <array>
#include <memory>

namespace strake::structure {

/// Supports as equations between particles, for places where no particle stands: centres lie half a spacing
/// inside a face. These are the middle line of a face that is pinned or rolls, and the whole of a face of
/// symmetry. Each constrained place gives one equation per constrained axis (N: `interpolation`):
///   Σ_j N_j u_j = D  (D: displacement of the supports),  or with particles that are fixed at D taken out
///   Σ_free N_j u_j = b D,  b = Σ_free N_j
/// The reactions act on the particles by the transposed weights. They do no work on supports at rest, so that
/// leapfrog stays symplectic (RATTLE).
template <int dim>
class Constraints {
 public:
  using Vector = Eigen::Matrix<double, dim, 1>;

  Constraints() = default;  // nothing is constrained
  /// `mass` [kg] of each particle; `frame_mass` [kg] along each axis, of what moves with D: infinite where D
  /// is prescribed. Throws Error(case_file) if a face cannot be constrained so.
  Constraints(const Lattice<dim>&, const Solid&, const Eigen::VectorXd& mass, const Vector& frame_mass);

  bool any() const;
  bool along(int axis) const { return axis_[static_cast<std::size_t>(axis)] != nullptr; }
  /// Gives velocities [m/s] that fulfil the equations but for `gap`/dt, by impulses on the particles and on a
  /// free frame; `gap` is what `gap()` says, or nothing for the derivative alone. The impulse [N s] of the
  /// supports on the body comes back.
  Vector project(Vectors<dim>& velocity, Vector& frame_velocity, const std::array<Eigen::VectorXd, dim>* gap,
                 double dt) const;
  /// Σ_free N_j u_j − b D of each equation [m].
  std::array<Eigen::VectorXd, dim> gap(const Vectors<dim>& displacement, const Vector& frame) const;
  /// The equations as matrix rows over the unknowns that `first` numbers. Particle i has first[i] + axis, or
  /// −1 where it is fixed.
  SparseRows rows(const std::vector<int>& first, int count) const;

 private:
  struct Axis {
    SparseRows weight;                                           // equations × particles
    Eigen::VectorXd of_frame;                                    // b
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors;  // of N M⁻¹ Nᵀ + b bᵀ/m_frame
    double frame_mass = 0;
  };
  std::array<std::unique_ptr<Axis>, dim> axis_;  // none: no equation along it
  Eigen::VectorXd mass_;
};

}  // namespace strake::structure
