#include "coupler/aitken.hpp"

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

// The last factor of a window serves the first iteration of the next within these bounds: a last secant taken
// from two residuals at round-off may be any number, and a step backwards or beyond H(x) is no start.
constexpr double smallest_start = 1e-3, largest_start = 1.0;

}  // namespace

void Aitken::learn(const Eigen::VectorXd& residual, const Eigen::VectorXd&) {
  double& relaxation = state_.relaxation;
  if (state_.iteration == 1) {
    relaxation = relaxation == 0 ? initial_ : std::clamp(std::abs(relaxation), smallest_start, largest_start);
    return;
  }
  const Eigen::VectorXd change = residual - state_.previous_residual;
  const double squared = change.squaredNorm();
  // No change at all says nothing about the map: keep the factor.
  if (squared > 0) relaxation *= -state_.previous_residual.dot(change) / squared;
  if (relaxation == 0) relaxation = initial_;
}

Eigen::VectorXd Aitken::iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  step_.relaxation = state_.relaxation;
  return x + state_.relaxation * (hx - x);
}

}  // namespace strake
