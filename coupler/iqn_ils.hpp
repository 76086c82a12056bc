#pragma once

#include "coupler/quasi_newton.hpp"

namespace strake {

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009).
/// With the columns ΔR = [r_k − r_(k−1) …] and ΔH = [H(x_k) − H(x_(k−1)) …] of this and earlier windows
///   α = argmin |ΔR α + r_k|,   x_(k+1) = H(x_k) + ΔH α
/// A column that brings too little that is new is left out, newest first, which also removes what an earlier
/// window contradicts.
class IqnIls : public QuasiNewton {
 public:
  using QuasiNewton::QuasiNewton;
  void start_window() override;

 protected:
  Eigen::VectorXd image_of(const Eigen::VectorXd& residual_change, Eigen::VectorXd image_change) override;
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override;
};

}  // namespace strake
