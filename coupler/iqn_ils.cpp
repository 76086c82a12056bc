#include "coupler/iqn_ils.hpp"

namespace strake {

using Eigen::VectorXd;

VectorXd IqnIls::image_of(const VectorXd&, VectorXd image_change) {
  return image_change;
}

VectorXd IqnIls::iterate(const VectorXd& x, const VectorXd& hx) {
  const VectorXd residual = hx - x;
  const LeastSquares problem = factorise(fine);
  step_.columns = static_cast<int>(problem.kept.size());
  step_.dropped = static_cast<int>(state_.secants.columns()) - step_.columns;
  if (problem.kept.empty()) {
    state_.relaxation = step_.relaxation = parameters_.initial_relaxation;
    return x + parameters_.initial_relaxation * residual;
  }
  VectorXd next = hx;
  add_times(state_.secants.images(problem),
            problem.alpha(state_.secants.project(sizes(x.size()), weights(), residual)), next);
  return next;
}

void IqnIls::start_window() {
  Accelerator::start_window();
  // Windows without columns (converged at once) leave no entry, so quiet spells do not wear the memory out.
  state_.secants.start_window(parameters_.reused_windows);
}

}  // namespace strake
