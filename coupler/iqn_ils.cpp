#include "coupler/iqn_ils.hpp"

#include <algorithm>

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A difference of residuals this small beside the iterates is their round-off.
constexpr double round_off = 1e-15;
// The map as this window shows it is worth finer columns than what an earlier window remembers: a linear map
// of n unknowns is solved in n + 2 iterations.
constexpr double own_filter = 1e-4;

/// Columns in the order in which they are taken: newest first.
struct Columns {
  std::vector<VectorXd> residual, image;
  std::size_t own = 0;  // so many from the current window
};

Columns newest_first(const std::vector<AcceleratorState::Secants>& windows, bool last_is_current) {
  Columns columns;
  if (last_is_current) columns.own = static_cast<std::size_t>(windows.back().residual.cols());
  for (auto w = windows.rbegin(); w != windows.rend(); ++w)
    for (Index c = w->residual.cols() - 1; c >= 0; --c) {
      columns.residual.push_back(w->residual.col(c));
      columns.image.push_back(w->image.col(c));
    }
  return columns;
}

}  // namespace

void IqnIls::learn(const VectorXd& residual, const VectorXd& image) {
  if (state_.iteration == 1) return;
  if (state_.iteration == 2) state_.windows.push_back({});
  auto& secants = state_.windows.back();
  secants.residual.conservativeResize(residual.size(), secants.residual.cols() + 1);
  secants.image.conservativeResize(image.size(), secants.image.cols() + 1);
  secants.residual.rightCols(1) = residual - state_.previous_residual;
  secants.image.rightCols(1) = image - state_.previous_image;
}

VectorXd IqnIls::iterate(const VectorXd& x, const VectorXd& hx) {
  const VectorXd residual = hx - x;
  // Gram–Schmidt, each column orthogonalised twice (Björck 1994: enough for orthogonality to round-off).
  const Columns columns = newest_first(state_.windows, state_.iteration > 1);
  std::vector<VectorXd> basis;
  std::vector<Index> kept;
  const Index limit = std::min<Index>(x.size(), static_cast<Index>(columns.residual.size()));
  MatrixXd triangle = MatrixXd::Zero(limit, limit);
  VectorXd length(limit);
  for (std::size_t c = 0; c < columns.residual.size() && static_cast<Index>(kept.size()) < limit; ++c) {
    const double norm = columns.residual[c].norm();
    if (columns.residual[c].size() != x.size() || norm <= round_off * hx.norm()) continue;
    VectorXd direction = columns.residual[c] / norm;
    const auto k = static_cast<Index>(kept.size());
    VectorXd projection = VectorXd::Zero(k);
    for (int pass = 0; pass < 2; ++pass)
      for (Index j = 0; j < k; ++j) {
        const double part = basis[static_cast<std::size_t>(j)].dot(direction);
        projection[j] += part;
        direction -= part * basis[static_cast<std::size_t>(j)];
      }
    const double fresh = direction.norm();
    if (fresh <= (c < columns.own ? std::min(filter_, own_filter) : filter_)) continue;
    triangle.col(k).head(k) = projection;
    triangle(k, k) = fresh;
    length[k] = norm;
    basis.push_back(direction / fresh);
    kept.push_back(static_cast<Index>(c));
  }
  step_.columns = static_cast<int>(kept.size());
  step_.dropped = static_cast<int>(columns.residual.size()) - step_.columns;
  if (kept.empty()) {
    state_.relaxation = step_.relaxation = initial_;
    return x + initial_ * residual;
  }

  const auto n = static_cast<Index>(kept.size());
  VectorXd right(n);
  for (Index j = 0; j < n; ++j) right[j] = -basis[static_cast<std::size_t>(j)].dot(residual);
  const VectorXd alpha = triangle.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(right);
  VectorXd next = hx;
  for (Index j = 0; j < n; ++j)
    next += alpha[j] / length[j] * columns.image[static_cast<std::size_t>(kept[static_cast<std::size_t>(j)])];
  return next;
}

void IqnIls::start_window() {
  Accelerator::start_window();
  // Windows without columns (converged at once) leave no entry, so quiet spells do not wear the memory out.
  const auto keep = static_cast<std::size_t>(std::max(reused_, 0));
  if (state_.windows.size() > keep)
    state_.windows.erase(state_.windows.begin(), state_.windows.end() - static_cast<std::ptrdiff_t>(keep));
}

}  // namespace strake
