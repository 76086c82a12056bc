#include "structure/fem/support_motion.hpp"

#include <Eigen/Dense>

#include <utility>
#include <vector>

namespace strake::structure::fem {

template <int dim>
SupportMotion<dim>::SupportMotion(SupportFrame supports, const Matrix& mass, const Mesh<dim>& mesh)
    : supports_(std::move(supports)), division_(mesh.division), carried_(mesh.n_unknowns(), dim) {
  Vector constrained = Vector::Zero();
  for (const int unknown : mesh.fixed) constrained[unknown % dim] = 1;
  std::vector<int> axes;
  for (int axis = 0; axis < dim; ++axis) {
    if (division_.max(constrained[axis]) == 0) supports_.stays_out(axis);
    Eigen::VectorXd one = Eigen::VectorXd::Zero(mesh.n_unknowns());
    for (int i = 0; i < mesh.n_nodes(); ++i) one(dim * i + axis) = 1;
    carried_.col(axis) = mass * one;
    mass_[axis] = division_.dot(one, carried_.col(axis)) + lumped_mass(axis);
    if (supports_.is_free(axis)) axes.push_back(axis);
  }
  W_.resize(mesh.n_unknowns(), static_cast<Eigen::Index>(axes.size()));
  W_mass_.resize(W_.cols());
  for (Eigen::Index k = 0; k < W_.cols(); ++k) {
    const int axis = axes[static_cast<std::size_t>(k)];
    W_.col(k) = carried_.col(axis);
    W_mass_[k] = mass_[axis];
  }
  for (const int unknown : mesh.fixed) W_.row(unknown).setZero();
}

// A prescribed axis has the mean of the step: of trapezoidal steps (V1 − V0)/dt, so that momentum is exact.
template <int dim>
typename SupportMotion<dim>::Vector SupportMotion<dim>::acceleration(
    const TimeScheme& scheme, const FrameState& from, const FrameState& to, const Eigen::VectorXd& force,
    const Eigen::VectorXd& inertia, const Vector& gravity, double dt) const {
  Vector A;
  for (int axis = 0; axis < dim; ++axis) {
    if (supports_.is_free(axis)) {
      const Eigen::Index own = division_.own(force.size());
      double sum = division_.first() ? supports_.mass() * gravity[axis] : 0;
      for (Eigen::Index i = axis; i < own; i += dim) sum += force[i] - inertia[i];
      A[axis] = division_.sum(sum) / mass_[axis];
    } else if (scheme.mid_point) {
      A[axis] = (to.velocity[axis] - from.velocity[axis]) / dt;
    } else {
      A[axis] = (1 - scheme.alpha_m) * to.acceleration[axis] + scheme.alpha_m * from.acceleration[axis];
    }
  }
  return A;
}

template <int dim>
FrameState SupportMotion<dim>::prescribed(const FrameState& from, double time) const {
  FrameState to = supports_.prescribed(time);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!supports_.is_free(axis)) continue;
    to.displacement[axis] = from.displacement[axis];
    to.velocity[axis] = from.velocity[axis];
    to.acceleration[axis] = from.acceleration[axis];
  }
  return to;
}

// The scheme's own formulas; by the trapezoidal rule A_m is all that a step leaves.
template <int dim>
void SupportMotion<dim>::advance(const TimeScheme& scheme, const FrameState& from, const Vector& A, double dt,
                                 FrameState& to) const {
  for (int axis = 0; axis < dim; ++axis) {
    if (!supports_.is_free(axis)) continue;
    const double V0 = from.velocity[axis], A0 = scheme.mid_point ? A[axis] : from.acceleration[axis];
    const double A1 = scheme.mid_point ? A[axis] : (A[axis] - scheme.alpha_m * A0) / (1 - scheme.alpha_m);
    to.acceleration[axis] = A1;
    to.velocity[axis] = V0 + dt * ((1 - scheme.gamma) * A0 + scheme.gamma * A1);
    to.displacement[axis] =
        from.displacement[axis] + dt * V0 + dt * dt * ((0.5 - scheme.beta) * A0 + scheme.beta * A1);
  }
}

template <int dim>
typename SupportMotion<dim>::Vector SupportMotion<dim>::gained(const Eigen::VectorXd& velocity_change,
                                                               const Eigen::Vector3d& frame_change) const {
  const Eigen::Index own = division_.own(velocity_change.size());
  const Vector of_body = carried_.topRows(own).transpose() * velocity_change.head(own);
  return Vector(division_.sum(of_body)) + mass_.cwiseProduct(frame_change.head<dim>());
}

// J⁻¹ r = x + Z S⁻¹ Wᵀ x with x = A⁻¹ r, Z = A⁻¹ W, S = (m + M_L)/κ − Wᵀ Z.
template <int dim>
typename SupportMotion<dim>::Correction SupportMotion<dim>::correction(const LinearSolver& A,
                                                                       double kappa) const {
  if (W_.cols() == 0) return [](const Eigen::VectorXd& x) { return x; };
  Eigen::MatrixXd Z(W_.rows(), W_.cols());
  for (Eigen::Index k = 0; k < W_.cols(); ++k) Z.col(k) = A.solve(W_.col(k));
  Eigen::MatrixXd S = -W_times(Z);
  S.diagonal() += W_mass_ / kappa;
  return [this, Z, S_inverse = Eigen::MatrixXd(S.inverse())](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(x + Z * (S_inverse * W_times(x)));
  };
}

template <int dim>
Eigen::MatrixXd SupportMotion<dim>::W_times(const Eigen::MatrixXd& x) const {
  const Eigen::Index own = division_.own(x.rows());
  return division_.sum(Eigen::MatrixXd(W_.topRows(own).transpose() * x.topRows(own)));
}

template class SupportMotion<2>;
template class SupportMotion<3>;

}  // namespace strake::structure::fem
