#include "coupler/acceleration/quasi_newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A difference of residuals this small beside the iterates is their round-off.
constexpr double round_off = 1e-15;

// Filter of this window's columns, finer than that of columns of earlier windows. A linear map of n unknowns
// is then solved in n + 2 iterations.
constexpr double fine = 1e-4;
// Values while columns may mislead: the filter of this window's columns, and the factor of the unexplained
// residual.
//
// Measured on the light plate of cases/plate_entry.toml (1000 kg/m³) in incompressible water, in the first 23
// windows of contact, without columns of earlier windows. 0.3 and 0.5 take 8.8 iterations per window and at
// most 13; 0.1 and 1, 10.2 and 20; with 1e-4 and 1 three windows do not converge in 20.
constexpr double coarse = 0.3, followed = 0.5;

}  // namespace

QuasiNewton::QuasiNewton(const AcceleratorParameters& parameters) : parameters_(parameters) {}

std::vector<Index> QuasiNewton::sizes(Index whole) const {
  if (blocks_.empty()) return {whole};
  std::vector<Index> sizes;
  for (const AcceleratorBlock& block : blocks_) sizes.push_back(block.size);
  return sizes;
}

void QuasiNewton::learn(const VectorXd& residual, const VectorXd& image) {
  weigh(residual);
  if (state_.iteration == 1) return;
  const VectorXd change = residual - state_.previous_residual;
  if (change.norm() <= round_off * image.norm()) return;
  VectorXd image_change = image - state_.previous_image;
  if (!state_.jacobian.left.empty()) image_change -= state_.jacobian.times(change);
  state_.secants.append(sizes(change.size()), change, std::move(image_change), parameters_.max_columns);
}

VectorXd QuasiNewton::iterate(const VectorXd& x, const VectorXd& hx) {
  const VectorXd residual = hx - x;
  const LeastSquares problem =
      factorise(careful() ? std::max(parameters_.filter, coarse) : std::min(parameters_.filter, fine));
  const auto own = static_cast<int>(problem.kept.size());
  step_.columns = own + static_cast<int>(state_.jacobian.left.size());
  step_.dropped = static_cast<int>(state_.secants.columns()) - own;
  if (step_.columns == 0) {
    state_.relaxation = step_.relaxation = parameters_.initial_relaxation;
    return x + parameters_.initial_relaxation * residual;
  }
  VectorXd next = hx;
  if (!state_.jacobian.left.empty()) next -= state_.jacobian.times(residual);
  if (own == 0) return next;
  const std::vector<Index> lengths = sizes(x.size());
  const VectorXd given = state_.secants.project(lengths, weights(), residual), alpha = problem.alpha(given);
  add_times(state_.secants.images(problem), alpha, next);
  const double size = weighted_norm(residual), explained = (problem.u.transpose() * given).norm();
  state_.unexplained = size > 0 ? std::sqrt(std::max(0.0, 1 - explained * explained / (size * size))) : 0;
  if (careful()) {
    VectorXd unexplained = residual;
    state_.secants.add_residuals(problem, alpha, lengths, unexplained);
    next -= (1 - followed) * unexplained;
  }
  return next;
}

// Weights w_b = 1/Σ_k |r_b^k| over the iterations k of the window. The residual-sum preconditioner (Uekermann
// 2016) sums the shares |r_b^k|/|r^k| instead. Then an iteration in which only one field has a residual would
// count as much as the first. This happens with a load that is not yet requested, or that has nearly
// converged. The fields would lose each other's scale.
void QuasiNewton::weigh(const VectorXd& residual) {
  const std::vector<Index> lengths = sizes(residual.size());
  if (state_.iteration == 1) state_.residual_sum = VectorXd::Zero(static_cast<Index>(lengths.size()));
  Index begin = 0, b = 0;
  for (const Index length : lengths) {
    state_.residual_sum[b++] += residual.segment(begin, length).norm();
    begin += length;
  }
}

VectorXd QuasiNewton::weights() const {
  const VectorXd& sum = state_.residual_sum;
  if (sum.size() < 2) return VectorXd::Ones(1);
  // A field without any residual has nothing to weigh.
  return sum.unaryExpr([](double s) { return s > 0 ? 1 / s : 1.0; });
}

double QuasiNewton::weighted_norm(const VectorXd& value) const {
  const VectorXd weight = weights();
  double square = 0;
  Index begin = 0, b = 0;
  for (const Index length : sizes(value.size())) {
    square += (weight[std::min(b, weight.size() - 1)] * value.segment(begin, length)).squaredNorm();
    begin += length;
    ++b;
  }
  return std::sqrt(square);
}

LeastSquares QuasiNewton::factorise(double own_filter) const {
  return state_.secants.factorise(
      weights(), {parameters_.filter_kind == "QR1" ? SecantFilter::Kind::qr1 : SecantFilter::Kind::qr2,
                  parameters_.filter, own_filter});
}

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

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Singular values of J below this part of the largest are forgotten when it starts again.
constexpr double smallest_singular = 1e-2;

}  // namespace

void IqnImvj::start_window() {
  Secants& secants = state_.secants;
  if (secants.columns() > 0) {
    const Index n = secants.image.front()->size();
    const std::vector<Index> lengths = sizes(n);
    // Carried columns are filtered as those of earlier windows are. For a fine column the linear model's
    // error, divided by the column's new part, would stay in J.
    const LeastSquares problem = factorise(parameters_.filter);
    state_.jacobian.add(secants.images(problem), secants.pseudo_inverse(problem, lengths, weights()));
    if (static_cast<int>(state_.jacobian.left.size()) > parameters_.max_columns) {
      VectorXd scale(n);
      Index begin = 0;
      for (std::size_t b = 0; b < lengths.size(); begin += lengths[b++])
        scale.segment(begin, lengths[b]).setConstant(weights()[static_cast<Index>(b)]);
      state_.jacobian.truncate(std::max(1, parameters_.max_columns / 2), smallest_singular, scale);
    }
    secants = {};
  }
  Accelerator::start_window();
}

}  // namespace strake
