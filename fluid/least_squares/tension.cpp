#include "fluid/least_squares/scheme.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace strake::fluid {

namespace {

/// How a particle counts as free surface in D_s. Beside a body that stood in the water it counts with its
/// share σ. Inside the water σ passes zero and one all the time, by a little. D_s may not jump by that: with
/// it jump the tension of the water and the velocity past curved faces. Beside other bodies a neighbour
/// counts with σ = 1 alone, and a particle with any σ lies at the surface itself. Their jets have σ between;
/// tension in these drew water into the body.
struct SurfaceInDepth {
  bool by_share;
  double no_tension_to() const {
    const LeastSquaresConstants& tuned = least_squares_constants();
    return by_share ? tuned.no_tension_beside : tuned.no_tension_to;
  }
  bool is_any(double share) const { return by_share ? share > 0 : share >= 1; }
  double own(double share) const { return by_share || share == 0 ? share : 1; }
};

/// Marks the water that has a particle of the free surface within reach.
void mark_surface_in_reach(auto& surface, const Neighbours& far, std::int64_t water, bool several,
                           SurfaceInDepth counts) {
  // Rows are symmetric: water within reach of the free surface is in the surface's rows. All threads write
  // the same value. On several ranks all water looks for the surface in its own rows, since ghosts have none.
  surface.in_reach.assign(static_cast<std::size_t>(water), several ? 1 : 0);
#pragma omp parallel for schedule(static) if (!several)
  for (std::int64_t j = 0; j < (several ? 0 : water); ++j) {
    if (!counts.is_any(surface.share[j])) continue;
    for (const std::int32_t i : far.row(j)) {
      if (i >= water) break;
      std::atomic_ref(surface.in_reach[static_cast<std::size_t>(i)]).store(1, std::memory_order_relaxed);
    }
  }
}

/// Returns (D_s/l0 − a)/(3.1 − a) within 0 and 1, a = 0.8 beside a body that stood in the water, else 1.6,
/// and D_s the distance of particle i from the free surface (F46),
///   D_s = min_j ( r_ij + (1 − σ_j) 3.1 l0 ) ,   j = i with r = 0 and the water within 3.1 l0.
double depth_share(const auto& surface, const Neighbours& far, std::int64_t water, double spacing,
                   std::int64_t i, SurfaceInDepth counts) {
  const double from = least_squares_constants().tension_from;
  const double none_to = counts.no_tension_to();
  double nearest = (1 - counts.own(surface.share[i])) * from;
  if (!(nearest > none_to)) return 0;
  if (!surface.in_reach[static_cast<std::size_t>(i)] && surface.share[i] == 0) return 1;
  const auto columns = far.row(i);
  const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
  for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e)
    if (const double share = surface.share[columns[e]]; counts.is_any(share))
      nearest = std::min(
          nearest, 1 / far.inverse_of(first + static_cast<std::int64_t>(e)) / spacing + (1 - share) * from);
  return std::clamp((nearest - none_to) / (from - none_to), 0.0, 1.0);
}

}  // namespace

/// Computes `depth_share` of all water.
template <int dim>
void LeastSquaresScheme<dim>::find_depth(const Boundary<dim>& boundary, const Neighbours& far) {
  mark_surface_in_reach(surface_, far, boundary.water(), ranks_.several(), {p_.submerged});
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    if (ranks_.owns(i))
      surface_.deep[i] =
          static_cast<float>(depth_share(surface_, far, boundary.water(), p_.spacing, i, {p_.submerged}));
  ranks_.update(surface_.deep);
}

// The suction on a body that moves under water is m_a dV/dt per area, m_a its added mass: some ρ a dV/dt, a
// the half width. While a body starts, and while an elastic one swings, ρ u² is far smaller. Water with that
// bound would let go of it. So the atmosphere alone bounds the tension beside a body that stood in the water.
template <int dim>
void LeastSquaresScheme<dim>::limit_tension(const Boundary<dim>& boundary, State<dim>& state,
                                            const Neighbours& far) {
  const double of_speed = p_.density * now_.largest_speed * now_.largest_speed;
  const double atmosphere = least_squares_constants().largest_tension;
  const double most = p_.submerged ? atmosphere : std::min(atmosphere, of_speed);
  if (p_.submerged)
    equation_.tension = surface_.deep;
  else {
    equation_.tension.setZero(boundary.water());
    mark_surface_in_reach(surface_, far, boundary.water(), ranks_.several(), {p_.submerged});
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!ranks_.owns(i) || state.pressure[i] > 0) continue;
    const double share = p_.submerged
                             ? surface_.deep[i]
                             : depth_share(surface_, far, boundary.water(), p_.spacing, i, {p_.submerged});
    const double limited = std::max(share * state.pressure[i], -most);
    if (share < 1 || limited > state.pressure[i])
      equation_.limited[static_cast<std::size_t>(i)] = Limit::tension;
    state.pressure[i] = limited;
  }
}

template void LeastSquaresScheme<2>::limit_tension(const Boundary<2>&, State<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::limit_tension(const Boundary<3>&, State<3>&, const Neighbours&);
template void LeastSquaresScheme<2>::find_depth(const Boundary<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::find_depth(const Boundary<3>&, const Neighbours&);

}  // namespace strake::fluid
