#pragma once

#include "coupler/acceleration/accelerator.hpp"

namespace strake {

/// Interface quasi-Newton. With a matrix J that maps a change of the residual to a change of H as far as it
/// is known from earlier windows (zero for IQN-ILS), and the secants ΔR = [r_k − r_(k−1) …] and ΔH = [H(x_k)
/// − H(x_(k−1)) …]
///   α = argmin |ΔR α + r_k|,   x_(k+1) = H(x_k) − J r_k + (ΔH − J ΔR) α
/// A column that brings too little that is new is left out, newest first, which also removes what an earlier
/// window contradicts. IQN-ILS and IQN-IMVJ differ in what a window leaves to the next.
class QuasiNewton : public Accelerator {
 public:
  explicit QuasiNewton(const AcceleratorParameters&);

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override;
  std::vector<Eigen::Index> sizes(Eigen::Index whole) const;  // of the blocks
  /// Weights w_b = 1 / Σ_k |r_b^k| over the iterations of this window. With them the remaining residual
  /// counts alike in every field, whatever its unit.
  Eigen::VectorXd weights() const;
  double weighted_norm(const Eigen::VectorXd&) const;
  /// Whether columns of this window may mislead, see IqnIls.
  bool careful() const { return state_.careful > 0; }
  /// own_filter: of the columns of this window.
  LeastSquares factorise(double own_filter) const;
  const AcceleratorParameters parameters_;

 private:
  void weigh(const Eigen::VectorXd& residual);
};

}  // namespace strake
