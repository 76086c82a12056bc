#include "fluid/correction.hpp"

#include <algorithm>

namespace strake::fluid {

namespace {

// Takes out of (d/n0) Σ_j (P_i + P_j) r_ij w/r² what lies along the walls of the tank.
template <int dim>
void smooth_walls(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                  const LatticeConstants& lattice, const Masks& masks, Vectors<dim>& gradient) {
  const std::int64_t water = boundary.water();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!masks.row.empty() && masks.row[static_cast<std::size_t>(i)] == 0) continue;
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    Vector<dim> along = Vector<dim>::Zero();
    for (std::size_t e = columns.size(); e > 0 && columns[e - 1] >= water;
         --e) {  // rows come after the water
      const std::int64_t j = columns[e - 1];
      const double w = lattice.radius * inverses[e - 1] - 1;
      const Vector<dim> normal = boundary.normal_of(j);
      if (w <= 0 || normal.squaredNorm() == 0) continue;
      if (!masks.column.empty() && masks.column[static_cast<std::size_t>(j)] == 0) continue;
      const Vector<dim> r = state.position.col(j) - state.position.col(i);
      along += (state.pressure[i] + state.pressure[j]) * w * inverses[e - 1] * inverses[e - 1] *
               (r - r.dot(normal) * normal);
    }
    gradient.col(i) -= dim / lattice.n0 * along;
  }
}

}  // namespace

template <int dim>
Vectors<dim> pressure_gradient(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                               const LatticeConstants& lattice, Gradient kind, const Masks& masks) {
  const auto& position = state.position;
  switch (kind) {
    case Gradient::min_pressure:
      return gradient_min_pressure<dim>(position, state.pressure, near, lattice, masks);
    case Gradient::pairwise: {
      Vectors<dim> gradient = gradient_pairwise<dim>(position, state.pressure, near, lattice, masks);
      smooth_walls<dim>(state, boundary, near, lattice, masks, gradient);
      return gradient;
    }
    case Gradient::corrected:
      break;
  }
  const auto correction = gradient_correction<dim>(position, near, lattice, masks);
  return gradient_corrected<dim>(position, state.pressure, near, lattice, correction, masks);
}

template <int dim>
void shift_particles(State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                     const LatticeConstants& lattice, double strength, double rest_speed, double dt,
                     double spacing) {
  if (strength <= 0) return;
  const std::int64_t water = boundary.water();
  Vectors<dim> concentration = Vectors<dim>::Zero(dim, water);  // ∇C [1/m]
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t e = 0; e < columns.size(); ++e) {
      const double w = lattice.radius * inverses[e] - 1;
      if (w > 0)
        sum += w * inverses[e] * inverses[e] * (state.position.col(columns[e]) - state.position.col(i));
    }
    concentration.col(i) = dim / lattice.n0 * sum;
  }
  Vectors<dim> shift = Vectors<dim>::Zero(dim, water);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const double reach = strength * (state.velocity.col(i).norm() + rest_speed) * dt * spacing;
    Vector<dim> direction = concentration.col(i);
    if (state.surface[static_cast<std::size_t>(i)]) {
      const double length = direction.norm();
      if (length == 0) continue;
      const Vector<dim> normal = direction / length;
      Vector<dim> mean = Vector<dim>::Zero();
      int count = 0;
      for (const std::int32_t j : near.row(i)) {
        if (j >= water || state.surface[static_cast<std::size_t>(j)]) continue;
        mean += concentration.col(j);
        ++count;
      }
      if (count == 0) continue;
      mean /= count;
      direction = mean - normal * normal.dot(mean);
    }
    Vector<dim> move = -reach * direction;
    const double length = move.norm(), limit = 0.1 * spacing;
    if (length > limit) move *= limit / length;
    shift.col(i) = move;
  }
  state.position.leftCols(water) += shift;
}

#define STRAKE_INSTANTIATE(dim)                                                                            \
  template Vectors<dim> pressure_gradient<dim>(const State<dim>&, const Boundary<dim>&, const Neighbours&, \
                                               const LatticeConstants&, Gradient, const Masks&);           \
  template void shift_particles<dim>(State<dim>&, const Boundary<dim>&, const Neighbours&,                 \
                                     const LatticeConstants&, double, double, double, double);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
