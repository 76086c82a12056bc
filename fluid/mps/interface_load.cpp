#include "fluid/mps/interface_load.hpp"

#include "fluid/mps/operators.hpp"

#include <cmath>

namespace strake::fluid {

namespace {

// Computes −V (d/n0) Σ_i α_i (P_i + P_j) (r_i − r_j) w/r² over the water i around layer particle j. α_i is
// the level of the water at a body, and 1 at the tank.
template <int dim>
Vector<dim> pair_reaction(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                          const LatticeConstants& lattice, double volume, const Eigen::VectorXd* level,
                          std::int64_t j) {
  const auto columns = near.row(j);
  const auto inverses = near.inverses(j);
  const auto seams = near.seams<dim>();
  const bool levelled = level && level->size() > 0 && j >= boundary.first_of_bodies();
  Vector<dim> sum = Vector<dim>::Zero();
  for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
    const double w = lattice.radius * inverses[e] - 1;
    if (w <= 0) continue;
    const double factor = levelled ? (*level)[columns[e]] : 1.0;
    sum += factor * (state.pressure[j] + state.pressure[columns[e]]) * w * inverses[e] * inverses[e] *
           seams.separation(state.position.col(j), state.position.col(columns[e]));
  }
  const Vector<dim> normal = boundary.normal_of(j);
  if (normal.squaredNorm() > 0) sum = normal * normal.dot(sum);  // smooth walls, see pressure_gradient
  return -volume * dim / lattice.n0 * sum;
}

// Computes −p n A of a first-layer particle, p extrapolated over the half spacing to the face.
template <int dim>
Vector<dim> face_force(const State<dim>& state, const Boundary<dim>& boundary, const LoadTerms<dim>& terms,
                       std::int64_t i) {
  const Vector<dim> area = boundary.face_area(i);  // into the water
  Vector<dim> field = terms.gravity - boundary.tank().acceleration_of(i);
  const Kind kind = state.kind[static_cast<std::size_t>(i)];
  if (kind != Kind::wall && terms.acceleration.cols() > 0)
    field -= boundary.at_point(terms.acceleration, boundary.point_of(i));
  const double size = area.norm();
  if (size == 0 || state.surface[static_cast<std::size_t>(i)]) return Vector<dim>::Zero();
  const Vector<dim> to_face = 0.5 * terms.spacing * area / size;
  return -(state.pressure[i] + terms.density * field.dot(to_face)) * area;
}

}  // namespace

template <int dim>
LayerForces<dim> layer_forces(const State<dim>& state, const Boundary<dim>& boundary, const Neighbours& near,
                              const LoadTerms<dim>& terms) {
  const auto n = state.position.cols();
  const double volume = std::pow(terms.spacing, dim), mass = terms.density * volume;
  LayerForces<dim> force = LayerForces<dim>::Zero(dim, n);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = boundary.water(); i < n; ++i) {
    const Kind kind = state.kind[static_cast<std::size_t>(i)];
    // Structure particles have no face to integrate over. The pair force is their load with every gradient.
    if (terms.gradient == Gradient::pairwise || kind == Kind::solid)
      force.col(i) = pair_reaction<dim>(state, boundary, near, terms.lattice, volume, terms.level, i);
    else if (kind == Kind::wall || kind == Kind::interface)
      force.col(i) = face_force<dim>(state, boundary, terms, i);
    if (terms.viscous.cols() == n) force.col(i) += mass * terms.viscous.col(i);
  }
  return force;
}

template <int dim>
Eigen::Matrix2Xd carried_pressure(const State<dim>& state, const Boundary<dim>& boundary,
                                  const Neighbours& near, const LatticeConstants& lattice) {
  const std::int64_t first = boundary.first_of_bodies(), count = state.position.cols() - first;
  Eigen::Matrix2Xd carried = Eigen::Matrix2Xd::Zero(2, count);
  for (std::int64_t k = 0; k < count; ++k) {
    const auto columns = near.row(first + k);
    const auto inverses = near.inverses(first + k);
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const double w = lattice.radius * inverses[e] - 1;
      if (w <= 0) continue;
      carried(0, k) += 0.5 * (state.pressure[first + k] + state.pressure[columns[e]]) * w;
      carried(1, k) += w;
    }
  }
  return carried;
}

template <int dim>
Vectors<dim> gather_on_points(const LayerForces<dim>& force, const Boundary<dim>& boundary) {
  Vectors<dim> on_points = Vectors<dim>::Zero(dim, boundary.points());
  for (std::int64_t i = boundary.first_of_bodies(); i < force.cols(); ++i)
    on_points.col(boundary.point_of(i)) += force.col(i);
  return on_points;
}

template <int dim>
Vector<dim> momentum_gap(const State<dim>& state, double particle_mass, const RankExchange<dim>& ranks) {
  Vector<dim> water = Vector<dim>::Zero();
  for (std::size_t i = 0; i < state.kind.size(); ++i)
    if (state.kind[i] == Kind::fluid && ranks.owns(static_cast<std::int64_t>(i)))
      water += particle_mass * state.velocity.col(static_cast<Eigen::Index>(i));
  water = ranks.sum(water);
  return water - state.initial_momentum - state.impulse_of_gravity + state.impulse_on_bodies +
         state.impulse_on_walls;
}

#define STRAKE_INSTANTIATE(dim)                                                                           \
  template LayerForces<dim> layer_forces<dim>(const State<dim>&, const Boundary<dim>&, const Neighbours&, \
                                              const LoadTerms<dim>&);                                     \
  template Eigen::Matrix2Xd carried_pressure<dim>(const State<dim>&, const Boundary<dim>&,                \
                                                  const Neighbours&, const LatticeConstants&);            \
  template Vectors<dim> gather_on_points<dim>(const LayerForces<dim>&, const Boundary<dim>&);             \
  template Vector<dim> momentum_gap<dim>(const State<dim>&, double, const RankExchange<dim>&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
