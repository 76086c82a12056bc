#include "fluid/mps/correction.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {

namespace {

// Subtracts from (d/n0) Σ_j (P_i + P_j) r_ij w/r² the component along the walls of the tank.
template <int dim>
void smooth_walls(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                  const LatticeConstants& lattice, const Masks& masks, Vectors<dim>& gradient) {
  const std::int64_t water = boundary.water();
  const auto seams = near.seams<dim>();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!masks.row.empty() && masks.row[static_cast<std::size_t>(i)] == 0) continue;
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    Vector<dim> along = Vector<dim>::Zero();
    for (std::size_t e = columns.size(); e > 0 && columns[e - 1] >= water;
         --e) {  // layers come after the water
      const std::int64_t j = columns[e - 1];
      const double w = lattice.radius * inverses[e - 1] - 1;
      const Vector<dim> normal = boundary.normal_of(j);
      if (w <= 0 || normal.squaredNorm() == 0) continue;
      if (!masks.column.empty() && masks.column[static_cast<std::size_t>(j)] == 0) continue;
      const Vector<dim> r = seams.separation(state.position.col(i), state.position.col(j));
      along += (state.pressure[i] + state.pressure[j]) * w * inverses[e - 1] * inverses[e - 1] *
               (r - r.dot(normal) * normal);
    }
    gradient.col(i) -= dim / lattice.n0 * along;
  }
}

/// Smallest sum of the water behind a particle, as a share of the full lattice's half sum.
constexpr double thin_water = 0.7;
constexpr double least_level = 0.5, largest_level = 2.0;

// Computes Σ w (r·n)/r² over the half lattice in front of n [1/m].
template <int dim>
double half_lattice_sum(const LatticeConstants& lattice, double spacing) {
  const int reach = static_cast<int>(std::ceil(lattice.radius / spacing));
  const int depth = dim == 3 ? reach : 0;
  double sum = 0;
  for (int z = -depth; z <= depth; ++z)
    for (int y = 1; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const double squared = (x * x + y * y + z * z) * spacing * spacing;
        sum += weight(std::sqrt(squared), lattice.radius) * y * spacing / squared;
      }
  return sum;
}

// Multiplies the pairs of water and body by α_i, the level of the water particle.
template <int dim>
void level_faces(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                 const LatticeConstants& lattice, const Masks& masks, const Eigen::VectorXd& level,
                 Vectors<dim>& gradient) {
  const auto seams = near.seams<dim>();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < level.size(); ++i) {
    if (level[i] == 1 || (!masks.row.empty() && masks.row[static_cast<std::size_t>(i)] == 0)) continue;
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t e = columns.size(); e > 0 && columns[e - 1] >= boundary.first_of_bodies(); --e) {
      const std::int64_t j = columns[e - 1];
      const double w = lattice.radius * inverses[e - 1] - 1;
      if (w <= 0 || (!masks.column.empty() && masks.column[static_cast<std::size_t>(j)] == 0)) continue;
      sum += (state.pressure[i] + state.pressure[j]) * w * inverses[e - 1] * inverses[e - 1] *
             seams.separation(state.position.col(i), state.position.col(j));
    }
    gradient.col(i) += (level[i] - 1) * dim / lattice.n0 * sum;
  }
}

}  // namespace

template <int dim>
Eigen::VectorXd face_level(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                           const LatticeConstants& lattice, double spacing) {
  Eigen::VectorXd level = Eigen::VectorXd::Ones(boundary.water());
  if constexpr (dim == 2) {
    if (boundary.body_surface().empty()) return level;
    const auto seams = near.seams<dim>();
    const double full = half_lattice_sum<dim>(lattice, spacing);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < level.size(); ++i) {
      const auto columns = near.row(i);
      if (columns.empty() || columns.back() < boundary.first_of_bodies()) continue;
      const Vector<dim> n = boundary.body_surface().normal(boundary.point_of(columns.back()));
      const auto inverses = near.inverses(i);
      double water = 0, body = 0;
      for (std::size_t e = 0; e < columns.size(); ++e) {
        const double w = lattice.radius * inverses[e] - 1;
        if (w <= 0) continue;
        const double share = w * inverses[e] * inverses[e] *
                             seams.separation(state.position.col(i), state.position.col(columns[e])).dot(n);
        if (columns[e] >= boundary.first_of_bodies())
          body -= share;
        else
          water += share;
      }
      if (body > 0 && water >= thin_water * full)
        level[i] = std::clamp(water / body, least_level, largest_level);
    }
  }
  return level;
}

template <int dim>
Vectors<dim> pressure_gradient(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                               const LatticeConstants& lattice, Gradient kind, const Masks& masks,
                               const Eigen::VectorXd& level) {
  const auto& position = state.position;
  switch (kind) {
    case Gradient::min_pressure:
      return gradient_min_pressure<dim>(position, state.pressure, near, lattice, masks);
    case Gradient::pairwise: {
      Vectors<dim> gradient = gradient_pairwise<dim>(position, state.pressure, near, lattice, masks);
      smooth_walls<dim>(state, boundary, near, lattice, masks, gradient);
      level_faces<dim>(state, boundary, near, lattice, masks, level, gradient);
      return gradient;
    }
    case Gradient::corrected:
    case Gradient::least_squares:
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
  const auto seams = near.seams<dim>();
  Vectors<dim> concentration = Vectors<dim>::Zero(dim, water);  // ∇C [1/m]
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const auto columns = near.row(i);
    const auto inverses = near.inverses(i);
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t e = 0; e < columns.size(); ++e) {
      const double w = lattice.radius * inverses[e] - 1;
      if (w > 0)
        sum += w * inverses[e] * inverses[e] *
               seams.separation(state.position.col(i), state.position.col(columns[e]));
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
                                               const LatticeConstants&, Gradient, const Masks&,            \
                                               const Eigen::VectorXd&);                                    \
  template Eigen::VectorXd face_level<dim>(const State<dim>&, const Boundary<dim>&, const Neighbours&,     \
                                           const LatticeConstants&, double);                               \
  template void shift_particles<dim>(State<dim>&, const Boundary<dim>&, const Neighbours&,                 \
                                     const LatticeConstants&, double, double, double, double);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
