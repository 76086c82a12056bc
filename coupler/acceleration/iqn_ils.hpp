#pragma once

#include "coupler/acceleration/quasi_newton.hpp"

namespace strake {

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009).
/// The columns of a window are reused in the next ones.
///
/// H has kinks where a pressure comes to zero, since water cannot pull. Columns from the other side of a kink
/// mislead. The sign is a step after which the residual is larger than the window's first, and larger than
/// any linear map could make it. Columns of earlier windows are then removed. In as many windows as would be
/// reused
///   none are reused;
///   only columns that are far from the newer ones are used beside them;
///   half of the unexplained residual r_k + ΔR α is added: in an unknown direction whose added mass is
///   μ times its own mass the full step would be μ times too long.
class IqnIls : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
};

}  // namespace strake
