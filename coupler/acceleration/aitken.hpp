#pragma once

#include "coupler/acceleration/accelerator.hpp"

namespace strake {

/// Relaxation by a factor that follows the last two residuals r = H(x) − x as one secant for the whole
/// vector:
///   ω_k = −ω_(k−1) r_(k−1)·(r_k − r_(k−1)) / |r_k − r_(k−1)|²,   x_(k+1) = x_k + ω_k r_k
/// (Irons & Tuck 1969 in the vector form of Küttler & Wall 2008). Exact for a scalar linear map after one
/// step. A window begins with the last factor of the one before, or the initial one if that is smaller. A
/// factor from a change that is not along the residual counts without its sign and is at least 1e-3.
class Aitken : public Accelerator {
 public:
  explicit Aitken(double initial_relaxation) : initial_(initial_relaxation) {}

 protected:
  void learn(const Eigen::VectorXd& residual, const Eigen::VectorXd& image) override;
  Eigen::VectorXd iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) override;

 private:
  double initial_;
};

}  // namespace strake
