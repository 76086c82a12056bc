#include "fluid/correction.hpp"

#include <algorithm>

namespace strake::fluid {

template <int dim>
Vectors<dim> pressure_gradient(const Vectors<dim>& position, const Eigen::VectorXd& pressure,
                               const Neighbours& near, const LatticeConstants& lattice, Gradient kind,
                               const Masks& masks) {
  switch (kind) {
    case Gradient::min_pressure:
      return gradient_min_pressure<dim>(position, pressure, near, lattice, masks);
    case Gradient::pairwise:
      return gradient_pairwise<dim>(position, pressure, near, lattice, masks);
    case Gradient::corrected:
      break;
  }
  const auto correction = gradient_correction<dim>(position, near, lattice, masks);
  return gradient_corrected<dim>(position, pressure, near, lattice, correction, masks);
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

#define STRAKE_INSTANTIATE(dim)                                                                      \
  template Vectors<dim> pressure_gradient<dim>(const Vectors<dim>&, const Eigen::VectorXd&,          \
                                               const Neighbours&, const LatticeConstants&, Gradient, \
                                               const Masks&);                                        \
  template void shift_particles<dim>(State<dim>&, const Boundary<dim>&, const Neighbours&,           \
                                     const LatticeConstants&, double, double, double, double);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
