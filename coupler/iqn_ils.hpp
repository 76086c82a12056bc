#pragma once

#include "coupler/accelerator.hpp"

namespace strake {

/// Interface quasi-Newton with an inverse Jacobian from least squares (Degroote, Bathe & Vierendeels 2009).
/// With the columns ΔR = [r_k − r_(k−1) …] and ΔH = [H(x_k) − H(x_(k−1)) …] of this and earlier windows
///   α = argmin |ΔR α + r_k|,   x_(k+1) = H(x_k) + ΔH α
/// solved by QR over columns scaled to unit length, newest first; a column that brings too little that is new
/// is left out, which also removes what an earlier window contradicts.
class IqnIls : public Accelerator {
 public:
  IqnIls(double initial_relaxation, int reused_windows, double filter)
      : initial_(initial_relaxation), reused_(reused_windows), filter_(filter) {}
  void start_window() override;

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override;

 private:
  double initial_;
  int reused_;
  double filter_;
};

}  // namespace strake
