// Water that starts packed: what the scheme remembers of it, and for how long.
#include "fluid/boundary/body_packing.hpp"
#include "fluid/least_squares/scheme.hpp"

#include <algorithm>

namespace strake::fluid {

// Layers behind a curved face are closer together than a lattice, and packed water is not as even as one.
// What this makes of δ and of m is no error of volume and no surface: it would drive currents in water at
// rest.
template <int dim>
void LeastSquaresScheme<dim>::note_start(const Boundary<dim>& boundary, const State<dim>& state,
                                         const Neighbours& far) {
  const std::int64_t water = boundary.water();
  start_.place.resize(dim, water);
  start_.deviation.resize(water);
  start_.opening.setZero(dim, water);
  for (std::int64_t i = 0; i < water; ++i) {
    const auto id = state.id[static_cast<std::size_t>(i)];
    const Vector<dim> x = state.position.col(i);
    start_.place.col(id) = boundary.tank().in_tank(x);
    start_.deviation[id] = static_cast<float>(volume_deviation(i));
    if (depth_of(boundary, x) < least_squares_constants().inner_depth * p_.spacing) continue;
    if (beside_open_side<dim>(p_, boundary, x, laplacian_.radius)) continue;
    const auto columns = far.row(i);
    const std::int64_t first = far.start()[static_cast<std::size_t>(i)];
    Vector<dim> opening = Vector<dim>::Zero();
    for (std::size_t e = 0; e < columns.size(); ++e) {
      const double w = walls_.pair_weight(columns[e], laplacian_.radius,
                                          far.inverse_of(first + static_cast<std::int64_t>(e)));
      opening += w * boundary.tank().periodic().separation(x, state.position.col(columns[e]));
    }
    start_.opening.col(id) = opening.template cast<float>();
  }
}

template <int dim>
double LeastSquaresScheme<dim>::start_share(const Boundary<dim>& boundary, const State<dim>& state,
                                            std::int64_t i) const {
  const Vector<dim> moved =
      boundary.tank().periodic().separation(start_.place.col(state.id[static_cast<std::size_t>(i)]),
                                            boundary.tank().in_tank(state.position.col(i)));
  return std::max(0.0, 1 - moved.norm() / p_.spacing);
}

template <int dim>
bool LeastSquaresScheme<dim>::starts_under_level(const State<dim>& state, std::int64_t i) const {
  if (!starts_packed()) return false;
  const double height = start_.place(1, state.id[static_cast<std::size_t>(i)]);
  return p_.water.max[1] - height > least_squares_constants().inner_depth * p_.spacing;
}

#define STRAKE_INSTANTIATE(dim)                                                                     \
  template bool LeastSquaresScheme<dim>::starts_under_level(const State<dim>&, std::int64_t) const; \
  template void LeastSquaresScheme<dim>::note_start(const Boundary<dim>&, const State<dim>&,        \
                                                    const Neighbours&);                             \
  template double LeastSquaresScheme<dim>::start_share(const Boundary<dim>&, const State<dim>&,     \
                                                       std::int64_t) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
