#include "fluid/least_squares/scheme.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace strake::fluid {

// The suction on a body that moves under water is m_a dV/dt per area, m_a its added mass: some ρ a dV/dt, a
// the half width. While a body starts, and while an elastic one swings, ρ u² is far smaller. Water with that
// bound would let go of it. So the atmosphere alone bounds the tension beside a body that stood in the water.
template <int dim>
void LeastSquaresScheme<dim>::limit_tension(const Boundary<dim>& boundary, State<dim>& state,
                                            const Neighbours& far) {
  const std::int64_t water = boundary.water();
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double of_speed = p_.density * now_.largest_speed * now_.largest_speed;
  const bool follows = p_.submerged;
  const double most = follows ? tuned.largest_tension : std::min(tuned.largest_tension, of_speed);
  equation_.tension.setZero(water);
  // Rows are symmetric: water within reach of the free surface is in the surface's rows. All threads write
  // the same value. On several ranks all water looks for the surface in its own rows, since ghosts have none.
  const bool several = ranks_.several();
  surface_.in_reach.assign(static_cast<std::size_t>(water), several ? 1 : 0);
#pragma omp parallel for schedule(static) if (!several)
  for (std::int64_t j = 0; j < (several ? 0 : water); ++j) {
    if (surface_.share[j] < 1) continue;
    for (const std::int32_t i : far.row(j)) {
      if (i >= water) break;
      std::atomic_ref(surface_.in_reach[static_cast<std::size_t>(i)]).store(1, std::memory_order_relaxed);
    }
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!ranks_.owns(i) || (!follows && state.pressure[i] > 0)) continue;
    if (!surface_.in_reach[static_cast<std::size_t>(i)] && !(surface_.share[i] > 0)) {
      if (follows) equation_.tension[i] = 1;
      if (!(state.pressure[i] < -most)) continue;
      state.pressure[i] = -most;
      equation_.limited[static_cast<std::size_t>(i)] = Limit::tension;
      continue;
    }
    const auto columns = far.row(i);
    const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
    double nearest = surface_.share[i] > 0 ? 0 : tuned.tension_from * p_.spacing;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e)
      if (surface_.share[columns[e]] >= 1)
        nearest = std::min(nearest, 1 / far.inverse_of(first + static_cast<std::int64_t>(e)));
    const double share = std::clamp(
        (nearest / p_.spacing - tuned.no_tension_to) / (tuned.tension_from - tuned.no_tension_to), 0.0, 1.0);
    if (follows) equation_.tension[i] = static_cast<float>(share);
    if (state.pressure[i] > 0) continue;
    const double limited = std::max(share * state.pressure[i], -most);
    if (share < 1 || limited > state.pressure[i])
      equation_.limited[static_cast<std::size_t>(i)] = Limit::tension;
    state.pressure[i] = limited;
  }
  if (follows) ranks_.update(equation_.tension);
}

template void LeastSquaresScheme<2>::limit_tension(const Boundary<2>&, State<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::limit_tension(const Boundary<3>&, State<3>&, const Neighbours&);

}  // namespace strake::fluid
