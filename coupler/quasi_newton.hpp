#pragma once

#include "coupler/accelerator.hpp"

namespace strake {

/// What IQN-ILS and IQN-IMVJ have in common: the secants of the iterations and their least-squares problem.
class QuasiNewton : public Accelerator {
 public:
  explicit QuasiNewton(const AcceleratorParameters&);

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
  /// What a change of the residual and of the image is remembered as.
  virtual Eigen::VectorXd image_of(const Eigen::VectorXd& residual_change, Eigen::VectorXd image_change) = 0;
  std::vector<Eigen::Index> sizes(Eigen::Index whole) const;  // of the blocks
  /// w_b = 1 / Σ_k |r_b^k| / |r^k| over the iterations of this window: what a field leaves weighs alike in
  /// every field, whatever its unit.
  Eigen::VectorXd weights() const;
  /// own_filter: of the columns of this window, where it is finer than the filter.
  LeastSquares factorise(double own_filter) const;
  // The map as this window shows it is worth finer columns than what an earlier window remembers: a linear
  // map of n unknowns is solved in n + 2 iterations.
  static constexpr double fine = 1e-4;

  const AcceleratorParameters parameters_;

 private:
  void weigh(const Eigen::VectorXd& residual);
};

}  // namespace strake
