#include "fluid/least_squares/scheme.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace strake::fluid {
namespace {

/// Whether a body rises in the water that it stood in at the start, in a tank at rest. The mean velocity of
/// its points against gravity exceeds 0.001 √(g l0).
///
/// The suction under a body that is lifted is m_a dV/dt per area, m_a its added mass: some ρ a dV/dt, a the
/// half width. While it starts, ρ u² is far smaller, and the water would let go of it.
template <int dim>
bool rises(const Parameters& p, const Vector<dim>& gravity, const State<dim>& state) {
  constexpr double least = 1e-3;
  if (!p.submerged || p.motion.moves() || state.interface_velocity.cols() == 0) return false;
  const double g = gravity.norm();
  const Vector<dim> up = g > 0 ? Vector<dim>(-gravity / g) : Vector<dim>(Vector<dim>::Unit(1));
  const Vector<dim> mean = state.interface_velocity.rowwise().mean();
  return mean.dot(up) > least * std::sqrt(g * p.spacing);
}

}  // namespace

template <int dim>
void LeastSquaresScheme<dim>::limit_tension(const Boundary<dim>& boundary, State<dim>& state,
                                            const Neighbours& far) {
  const std::int64_t water = boundary.water();
  const LeastSquaresConstants& tuned = least_squares_constants();
  const double of_speed = p_.density * now_.largest_speed * now_.largest_speed;
  const double most =
      rises<dim>(p_, now_.gravity, state) ? tuned.largest_tension : std::min(tuned.largest_tension, of_speed);
  equation_.tension = false;
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
    if (!ranks_.owns(i) || state.pressure[i] > 0) continue;
    if (!surface_.in_reach[static_cast<std::size_t>(i)] && !(surface_.share[i] > 0)) {
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
    const double limited = std::max(share * state.pressure[i], -most);
    if (share < 1 || limited > state.pressure[i])
      equation_.limited[static_cast<std::size_t>(i)] = Limit::tension;
    state.pressure[i] = limited;
  }
}

template void LeastSquaresScheme<2>::limit_tension(const Boundary<2>&, State<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::limit_tension(const Boundary<3>&, State<3>&, const Neighbours&);

}  // namespace strake::fluid
