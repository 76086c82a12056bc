#include "structure/deck/history.hpp"

#include "structure/body/surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake::structure::deck {

std::vector<Stretch> stretches(const LoadHistory& history) {
  constexpr double rounding = 1e-6;  // of a window: its end is a sum of many
  std::vector<Stretch> list;
  for (std::size_t k = 0; k + 1 < history.time.size(); ++k) {
    const double dt = history.time[k + 1] - history.time[k];
    if (list.empty() || std::abs(dt - list.back().dt) > rounding * dt)
      list.push_back({.windows = 0, .dt = dt, .end = 0});
    ++list.back().windows;
    list.back().end = history.time[k + 1];
  }
  // One length for all windows of a stretch, so that they end where it ends.
  double begin = 0;
  for (Stretch& s : list) {
    s.dt = (s.end - begin) / static_cast<double>(s.windows);
    begin = s.end;
  }
  return list;
}

LoadHistory nodal_history(const Model& model, const std::vector<Window>& windows,
                          const std::vector<Points>& force) {
  assert(!windows.empty() && windows.size() == force.size());
  const std::size_t n = windows.size();
  const int dim = model.dimension;
  const double start = windows.front().t;

  // Nᵀ f of each window, unknowns × windows.
  Eigen::MatrixXd mean(dim * model.node.cols(), static_cast<Eigen::Index>(n));
  for (std::size_t w = 0; w < n; ++w) {
    const Eigen::MatrixXd nodal = model.interface.transpose() * force[w].topRows(dim).transpose();
    mean.col(static_cast<Eigen::Index>(w)) = nodal.transpose().reshaped();
  }

  LoadHistory history;
  Eigen::MatrixXd all(mean.rows(), static_cast<Eigen::Index>(n + 1));
  for (std::size_t k = 0; k <= n; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double time = k < n ? windows[k].t : windows[n - 1].t + windows[n - 1].dt;
    history.time.push_back(time - start);
    if (k == 0) {
      all.col(0) = mean.col(0);
    } else if (k == n) {
      all.col(column) = mean.col(column - 1);
    } else {
      const double before = windows[k - 1].dt, after = windows[k].dt;
      all.col(column) = (before * mean.col(column - 1) + after * mean.col(column)) / (before + after);
    }
    all.col(column) += ramp_factor(time, model.own_load_ramp) * model.own_load;
    history.gravity.push_back(ramp_factor(time, model.gravity_ramp));
  }

  history.largest = all.cwiseAbs().maxCoeff();
  const double nothing = 1e-12 * history.largest;  // what shape functions leave where they should vanish
  for (int i = 0; i < all.rows(); ++i)
    if (!std::binary_search(model.fixed.begin(), model.fixed.end(), i) &&
        all.row(i).cwiseAbs().maxCoeff() > nothing)
      history.unknown.push_back(i);
  history.value = all(history.unknown, Eigen::all);
  return history;
}

}  // namespace strake::structure::deck
