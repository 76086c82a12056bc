#pragma once

#include "structure/fem/element/assembly.hpp"
#include "structure/fem/linear/linear_solver.hpp"
#include "structure/fem/mesh/mesh.hpp"
#include "structure/fem/newmark.hpp"
#include "structure/rigid/support_frame.hpp"

#include <functional>

namespace strake::structure::fem {

/// The motion of the supports' frame as part of a step. With u relative to the frame and 1_k a unit motion of
/// the whole body along axis k, m_k = 1_kᵀ M 1_k, M_L the lumped mass:
///   M a + Σ_k M 1_k A_k + C v + f(u) = F in the unknowns that are free, (m_k + M_L) A_k + 1_kᵀ M a = 1_kᵀ F
///   + M_L g_k along the axes in which the frame is free.
/// The supports' forces on body and frame are opposite, so that only loads change the momentum of both. A_k
/// depends on a alone and is eliminated. F has entries in constrained unknowns too.
template <int dim>
class SupportMotion {
 public:
  using Vector = Eigen::Matrix<double, dim, 1>;

  SupportMotion(SupportFrame, const Matrix& mass, const Mesh<dim>&);
  const SupportFrame& supports() const { return supports_; }

  /// Acceleration A_m of a step to `to`, whose prescribed axes are filled in. force: load F; inertia: M a_m
  /// of the body.
  Vector acceleration(const TimeScheme&, const FrameState& from, const FrameState& to,
                      const Eigen::VectorXd& force, const Eigen::VectorXd& inertia, const Vector& gravity,
                      double dt) const;
  /// Prescribed axes at a time; the others as in `from`.
  FrameState prescribed(const FrameState& from, double time) const;
  /// Free axes after a step with A_m.
  void advance(const TimeScheme&, const FrameState& from, const Vector& acceleration, double dt,
               FrameState& to) const;
  /// Σ_k M 1_k A_k.
  Eigen::VectorXd inertia(const Vector& acceleration) const { return carried_ * acceleration; }
  /// Momentum Δp_k of body and free frame that a change of relative and frame velocity makes [kg m/s].
  Vector gained(const Eigen::VectorXd& velocity_change, const Eigen::Vector3d& frame_change) const;
  double lumped_mass(Eigen::Index axis) const { return supports_.is_free(axis) ? supports_.mass() : 0; }

  /// J⁻¹ r from A⁻¹ r for J = A − κ Σ_free W_k W_kᵀ/(m_k + M_L), by Woodbury's formula. W = M 1 in the free
  /// unknowns.
  using Correction = std::function<Eigen::VectorXd(const Eigen::VectorXd& x)>;
  Correction correction(const LinearSolver& A, double kappa) const;

 private:
  SupportFrame supports_;
  RankDivision division_;
  Eigen::MatrixXd carried_;                                 // n×dim M 1_k
  Vector mass_;                                             // m_k + M_L
  Eigen::MatrixXd W_;                                       // n×(free axes)
  Eigen::VectorXd W_mass_;                                  // m_k + M_L of those
  Eigen::MatrixXd W_times(const Eigen::MatrixXd& x) const;  // Wᵀ x
};

}  // namespace strake::structure::fem
