#pragma once

#include "coupler/acceleration/quasi_newton.hpp"

namespace strake {

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009): a
/// window leaves its columns to the next ones.
///
/// Where H has kinks, as that of water that cannot pull has wherever a pressure comes to zero, columns from
/// the other side of a kink mislead. It shows in a step after which the residual is larger than the window's
/// first, and than any linear map could make it. Columns of earlier windows are forgotten then, and in as
/// many windows as would be reused
///   none are reused;
///   only columns that are far from the newer ones are used beside them;
///   what the columns do not explain, r_k + ΔR α, is followed half: an unknown direction whose added mass is
///   μ times its own would be thrown μ times too far.
class IqnIls : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
};

}  // namespace strake
