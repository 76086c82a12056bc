#include "coupler/quasi_newton.hpp"

#include <cmath>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A difference of residuals this small beside the iterates is their round-off.
constexpr double round_off = 1e-15;

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
  state_.secants.append(sizes(change.size()), change, image_of(change, image - state_.previous_image),
                        parameters_.max_columns);
}

// w_b = 1/Σ_k |r_b^k| over the iterations k of the window. With the shares |r_b^k|/|r^k| in the sum, as the
// residual-sum preconditioner has it (Uekermann 2016), an iteration in which only one field has a residual (a
// load not yet asked for, or all but converged) would count as much as the first, and the fields would lose
// each other's scale.
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

LeastSquares QuasiNewton::factorise(double own_filter) const {
  return state_.secants.factorise(
      weights(), {parameters_.filter_kind == "QR1" ? SecantFilter::Kind::qr1 : SecantFilter::Kind::qr2,
                  parameters_.filter, own_filter});
}

}  // namespace strake
