#include "coupler/acceleration/aitken.hpp"

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

// The last factor of a window starts the next, unless it is larger than the first factor of all. A last
// secant from two residuals at round-off may be any number.
constexpr double smallest = 1e-3;

// One factor suits a vector only if its residual changes along itself. If the cosine between the residual and
// its change is smaller than the root of this, other directions determine the sign and size of the factor.
// With such a factor the iteration stalls far from the solution.
constexpr double aligned = 0.8;

}  // namespace

void Aitken::learn(const Eigen::VectorXd& residual, const Eigen::VectorXd&) {
  double& relaxation = state_.relaxation;
  if (state_.iteration == 1) {
    relaxation = relaxation == 0 ? initial_ : std::min(initial_, std::max(std::abs(relaxation), smallest));
    return;
  }
  const Eigen::VectorXd change = residual - state_.previous_residual;
  const double squared = change.squaredNorm(), before = state_.previous_residual.squaredNorm();
  const double along = -state_.previous_residual.dot(change);
  // No change at all says nothing about the map: keep the factor.
  if (squared > 0) relaxation *= along / squared;
  if (along * along < aligned * squared * before) relaxation = std::max(std::abs(relaxation), smallest);
  if (relaxation == 0) relaxation = initial_;
}

Eigen::VectorXd Aitken::iterate(const Eigen::VectorXd& x, const Eigen::VectorXd& hx) {
  step_.relaxation = state_.relaxation;
  return x + state_.relaxation * (hx - x);
}

}  // namespace strake
