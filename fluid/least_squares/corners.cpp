#include "fluid/least_squares/scheme.hpp"
#include "fluid/particles/pair_loop.hpp"

#include <algorithm>
#include <limits>
#include <vector>

// Water at a sharp corner under water. A quarter or more of its neighbours lacks, and none of the faces lies
// before it. Its own pressure then drives it away from the corner and into its neighbours, ∇·u answers with a
// higher pressure, and so on: the feedback that (F47) ends with b beside the free surface. A pressure below
// the neighbours' drives it into the corner, ∇·u answers with a lower one. Measured at a floating box,
// spacing 12.5 mm: 6.2 kPa where still water has 0.48, and a particle of 0.8 m/s in water that moves at 0.1
// m/s; with 20 mm -2.1 kPa and 0.5 m/s.

namespace strake::fluid {

namespace {

/// Whether particle i lies at the end of all wet faces beside it: at a sharp end at most `at_end` inside it,
/// at a keel in space `at_keel`, and less than `past_end` past one of them.
template <int dim>
bool is_at_corner(const Boundary<dim>& boundary, const WallContact<dim>& walls, const State<dim>& state,
                  std::span<const std::int32_t> columns, std::int64_t i, double spacing) {
  const LeastSquaresConstants& tuned = least_squares_constants();
  bool near = false;
  for (std::size_t e = columns.size(); e-- > 0;) {  // layers of bodies stand last
    const std::int64_t j = columns[e];
    if (j < boundary.first_of_bodies()) break;
    if (!walls.wet(j)) continue;
    const int point = boundary.point_of(j);
    const double to_end = boundary.inside_free_end(point, state.position.col(i)) / spacing,
                 to_keel = boundary.inside_keel(point, state.position.col(i)) / spacing;
    const bool at_end = to_end <= tuned.at_end, at_keel = to_keel <= tuned.at_keel;
    if (!at_end && !at_keel) return false;
    near = near || (at_end && to_end > -tuned.past_end) || (at_keel && to_keel > -tuned.past_end);
  }
  return near;
}

}  // namespace

/// Limits the pressure of water at a corner by its neighbours' (F89), each carried to its place with the
/// slope of still water, p_ij = p_j − ρ g·r:
///   min_j p_ij ≤ p_i ≤ max(0, Σ_water w p_ij/Σ_water w)
template <int dim>
void LeastSquaresScheme<dim>::limit_at_corners(const Boundary<dim>& boundary, State<dim>& state,
                                               const Neighbours& near) {
  struct Bound {
    std::int64_t i;
    double pressure;
  };
  std::vector<Bound> bounds;  // all are found before any is used: two may be neighbours
#pragma omp parallel
  {
    std::vector<Bound> own;
#pragma omp for schedule(static) nowait
    for (std::int64_t i = 0; i < boundary.water(); ++i) {
      if (!ranks_.owns(i) || state.surface[static_cast<std::size_t>(i)]) continue;
      const auto columns = near.row(i);
      if (!is_at_corner(boundary, walls_, state, columns, i, p_.spacing)) continue;
      const auto inverses = near.inverses(i);
      double sum = 0, weights = 0, least = std::numeric_limits<double>::infinity();
      for (std::size_t e = 0, inner = water_pairs(columns, boundary.water()); e < inner; ++e) {
        const double w = gradient_.radius * inverses[e] - 1;
        const Vector<dim> r =
            boundary.tank().periodic().separation(state.position.col(i), state.position.col(columns[e]));
        const double carried = state.pressure[columns[e]] - p_.density * now_.gravity.dot(r);
        sum += w * carried;
        weights += w;
        least = std::min(least, carried);
      }
      const double most = weights > 0 ? std::max(0.0, sum / weights) : 0.0;
      const double bound = std::clamp(state.pressure[i], std::min(least, most), most);
      if (bound != state.pressure[i]) own.push_back({i, bound});
    }
#pragma omp critical(limits_at_corners)
    bounds.insert(bounds.end(), own.begin(), own.end());
  }
  for (const Bound& bound : bounds) {
    state.pressure[bound.i] = bound.pressure;
    equation_.limited[static_cast<std::size_t>(bound.i)] = Limit::at_surface;
  }
}

template void LeastSquaresScheme<2>::limit_at_corners(const Boundary<2>&, State<2>&, const Neighbours&);
template void LeastSquaresScheme<3>::limit_at_corners(const Boundary<3>&, State<3>&, const Neighbours&);

}  // namespace strake::fluid
