#include "coupler/acceleration/iqn_ils.hpp"

#include <algorithm>
#include <utility>

namespace strake {

using Eigen::VectorXd;

namespace {

/// How much larger than that of a linear map a residual must be for columns to have misled.
constexpr double slack = 2;

}  // namespace

// Detects columns that mislead, by the bound of a linear H. There r_(k+1) = e + M e: e = r_k + ΔR α is the
// unexplained residual, and M the slope of the residual. |Δr|/|Δx| of the other steps estimates the size of
// M.
void IqnIls::learn(const VectorXd& residual, const VectorXd& image) {
  const bool by_columns = state_.secants.columns() > 0;
  QuasiNewton::learn(residual, image);
  if (state_.iteration == 1) {
    state_.first = weighted_norm(residual);
    return;
  }
  const double before = weighted_norm(state_.previous_residual), now = weighted_norm(residual);
  const double slope = std::max(state_.steepest, state_.steepest_before);
  if (by_columns && now > state_.first && now > slack * (1 + slope) * state_.unexplained * before) {
    state_.careful = 1 + parameters_.reused_windows;
    state_.secants.forget_earlier();
  }
  const VectorXd change = residual - state_.previous_residual;
  const double moved = weighted_norm(image - state_.previous_image - change);
  if (moved > 0) state_.steepest = std::max(state_.steepest, weighted_norm(change) / moved);
}

void IqnIls::start_window() {
  Accelerator::start_window();
  state_.careful = std::max(0, state_.careful - 1);
  state_.steepest_before = std::exchange(state_.steepest, 0.0);
  state_.unexplained = 0;
  // Windows without columns (converged at once) leave no entry, so quiet spells do not wear the memory out.
  state_.secants.start_window(careful() ? 0 : parameters_.reused_windows);
}

}  // namespace strake
