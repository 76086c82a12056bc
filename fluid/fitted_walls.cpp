#include "fluid/fitted_scheme.hpp"

#include <algorithm>
#include <cmath>

namespace strake::fluid {

namespace {
/// Water so near to the middle of a face says what velocity and pressure are there [l0].
constexpr double face_reach = 1.6;
}  // namespace

template <int dim>
bool FittedScheme<dim>::over(const Boundary<dim>& boundary, const State<dim>& state, std::int64_t i,
                             std::int64_t row) const {
  return row < boundary.first_of_bodies() || boundary.volume() ||
         boundary.is_over(boundary.point_of(row), state.position.col(i));
}

template <int dim>
Vector<dim> FittedScheme<dim>::approach(const Boundary<dim>& boundary, const State<dim>& state,
                                        std::int64_t i, std::int64_t j) const {
  if (!over(boundary, state, i, j)) {
    const std::int32_t master = boundary.master_of(j);
    return mean_approach_.col(master < 0 ? j : master);
  }
  Vector<dim> u = state.velocity.col(i) - state.velocity.col(j);
  if (walls_.corner(j)) return u;
  // ∇u* carries the particle's velocity to the face; beside the free surface it is one-sided and left out.
  const double height =
      walls_.height(j, state.position.col(j),
                    boundary.tank().periodic().separation(state.position.col(j), state.position.col(i)) +
                        state.position.col(j));
  const double trust = 1 - surface_share_[i];
  u -= trust * height * (velocity_gradient(i) * walls_.normal(j));
  return u;
}

template <int dim>
double FittedScheme<dim>::still_pressure(const Boundary<dim>& boundary, const Vector<dim>& x) const {
  const double depth = p_.water.max[1] - boundary.tank().in_tank(x)[1];
  return std::max(0.0, -p_.density * gravity_[1] * depth);
}

template <int dim>
Vector<dim> FittedScheme<dim>::yielding(const Boundary<dim>& boundary, const State<dim>& state,
                                        std::int64_t i, std::int64_t j) const {
  if (!boundary.tank().absorbs()) return Vector<dim>::Zero();
  const double excess = state.pressure[i] - still_pressure(boundary, state.position.col(i));
  return excess / (p_.density * p_.sound_speed) * boundary.tank().absorbing(j);
}

template <int dim>
void FittedScheme<dim>::approach_from_mean(const Boundary<dim>& boundary, const State<dim>& state,
                                           const Neighbours& far) {
  const auto n = static_cast<std::int64_t>(state.kind.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t j = boundary.first_of_bodies(); j < n; ++j) {
    if (boundary.master_of(j) >= 0 || !walls_.wet(j)) continue;
    const Vector<dim> face = state.position.col(j) + walls_.depth(j) * walls_.normal(j);
    const auto columns = far.row(j);
    Vector<dim> sum = Vector<dim>::Zero();
    double weights = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < boundary.water(); ++e) {
      const std::int64_t i = columns[e];
      const Vector<dim> to_face = boundary.tank().periodic().separation(state.position.col(i), face);
      const double q = to_face.norm() / (face_reach * p_.spacing);
      if (q >= 1 || !over(boundary, state, i, j)) continue;
      const double w = (1 - q) * (1 - q);
      sum += w * (state.velocity.col(i) + velocity_gradient(i) * to_face);
      weights += w;
    }
    mean_approach_.col(j).setZero();
    if (weights > 0) mean_approach_.col(j) = sum / weights - state.velocity.col(j);
  }
}

// Sound through a layer h: over the depth h the slope falls as exp(−x/(cΔt)), so that its mean is
// (cΔt/h) (1 − exp(−h/(cΔt))) of that at the face; 1 for c = ∞.
template <int dim>
double FittedScheme<dim>::slope_share(double dt) const {
  if (!std::isfinite(p_.sound_speed)) return 1;
  const double layers = 0.5 * p_.spacing / (p_.sound_speed * dt);
  return (1 - std::exp(-layers)) / layers;
}

template <int dim>
RowForces<dim> FittedScheme<dim>::row_forces(const Boundary<dim>& boundary, State<dim>& state,
                                             const Neighbours& near, double dt) const {
  const auto n = static_cast<std::int64_t>(state.kind.size());
  const std::int64_t water = boundary.water();
  const double slope = slope_share(dt) * p_.density / dt;
  RowForces<dim> forces = RowForces<dim>::Zero(dim, n);
#pragma omp parallel for schedule(static)
  for (std::int64_t j = water; j < n; ++j) {
    if (boundary.master_of(j) >= 0 || !walls_.wet(j) || walls_.corner(j)) continue;
    const Vector<dim> normal = walls_.normal(j);
    const Vector<dim> face = state.position.col(j) + walls_.depth(j) * normal;
    const auto columns = near.row(j);
    const auto inverses = near.inverses(j);
    double sum = 0, weights = 0;
    for (std::size_t e = 0; e < columns.size() && columns[e] < water; ++e) {
      const std::int64_t i = columns[e];
      const double w = gradient_.radius * inverses[e] - 1;
      if (w <= 0 || !over(boundary, state, i, j)) continue;
      const double up = normal.dot(boundary.tank().periodic().separation(state.position.col(i), face));
      sum += w * (state.pressure[i] +
                  slope * up * normal.dot(approach(boundary, state, i, j) + yielding(boundary, state, i, j)));
      weights += w;
    }
    if (weights <= 0) continue;
    state.pressure[j] = sum / weights;
    forces.col(j) = -state.pressure[j] * boundary.face_area(j);
  }
  return forces;
}

#define STRAKE_INSTANTIATE(dim)                                                                              \
  template bool FittedScheme<dim>::over(const Boundary<dim>&, const State<dim>&, std::int64_t, std::int64_t) \
      const;                                                                                                 \
  template Vector<dim> FittedScheme<dim>::approach(const Boundary<dim>&, const State<dim>&, std::int64_t,    \
                                                   std::int64_t) const;                                      \
  template void FittedScheme<dim>::approach_from_mean(const Boundary<dim>&, const State<dim>&,               \
                                                      const Neighbours&);                                    \
  template Vector<dim> FittedScheme<dim>::yielding(const Boundary<dim>&, const State<dim>&, std::int64_t,    \
                                                   std::int64_t) const;                                      \
  template double FittedScheme<dim>::still_pressure(const Boundary<dim>&, const Vector<dim>&) const;         \
  template double FittedScheme<dim>::slope_share(double) const;                                              \
  template RowForces<dim> FittedScheme<dim>::row_forces(const Boundary<dim>&, State<dim>&,                   \
                                                        const Neighbours&, double) const;
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
