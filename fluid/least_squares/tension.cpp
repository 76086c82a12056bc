#include "fluid/least_squares/scheme.hpp"

#include <algorithm>
#include <atomic>

namespace strake::fluid {

namespace {
/// Water nearer than the first to the free surface parts without tension; from the second on, which is the
/// Laplacian's reach, air finds no way in and it holds all [l0].
constexpr double parts_to = 1.6, holds_from = 3.1;
}  // namespace

template <int dim>
void LeastSquaresScheme<dim>::release_tension(const Boundary<dim>& boundary, State<dim>& state,
                                              const Neighbours& far) {
  const std::int64_t water = boundary.water();
  const double most = std::min(largest_tension, p_.density * speed_ * speed_);
  tension_ = false;
  // Rows are symmetric: what sees the free surface is in the surface's rows. All who write there write the
  // same.
  sees_surface_.assign(static_cast<std::size_t>(water), 0);
#pragma omp parallel for schedule(static)
  for (std::int64_t j = 0; j < water; ++j) {
    if (surface_share_[j] < 1) continue;
    for (const std::int32_t i : far.row(j)) {
      if (i >= water) break;
      std::atomic_ref(sees_surface_[static_cast<std::size_t>(i)]).store(1, std::memory_order_relaxed);
    }
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (state.pressure[i] > 0) continue;
    if (!sees_surface_[static_cast<std::size_t>(i)] && !(surface_share_[i] > 0)) {
      if (!(state.pressure[i] < -most)) continue;
      state.pressure[i] = -most;
      cut_[static_cast<std::size_t>(i)] = Cut::released;
      continue;
    }
    const auto columns = far.row(i);
    const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
    double nearest = surface_share_[i] > 0 ? 0 : holds_from * p_.spacing;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e)
      if (surface_share_[columns[e]] >= 1)
        nearest = std::min(nearest, 1 / far.inverse_of(first + static_cast<std::int64_t>(e)));
    const double held = std::clamp((nearest / p_.spacing - parts_to) / (holds_from - parts_to), 0.0, 1.0);
    const double limited = std::max(held * state.pressure[i], -most);
    if (held < 1 || limited > state.pressure[i]) cut_[static_cast<std::size_t>(i)] = Cut::released;
    state.pressure[i] = limited;
  }
}

template void LeastSquaresScheme<2>::release_tension(const Boundary<2>&, State<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::release_tension(const Boundary<3>&, State<3>&, const Neighbours&);

}  // namespace strake::fluid
