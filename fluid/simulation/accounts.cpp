#include "fluid/mps/interface_load.hpp"
#include "fluid/simulation/step.hpp"

#include <algorithm>
#include <cmath>

// The results of a step and its accounts: loads, lost particles, momentum.

namespace strake::fluid {

namespace {

/// Returns the part of a face of that length that lies within the reach of a sensor, `away` from its middle
/// [m]. Whole faces would shift the sensor's middle by up to half a face. On a slope that is a change of
/// pressure.
double covered_part(double away, double length, double reach) {
  const double covered = std::min(away + 0.5 * length, reach) - std::max(away - 0.5 * length, -reach);
  return std::clamp(covered / length, 0.0, 1.0);
}

}  // namespace

template <int dim>
void Simulation<dim>::Work::take_load(Load<dim> load) {
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  step.ranks.gather_bodies(load.on_layers);
  const LayerForces<dim>& forces = load.on_layers;
  on_points = gather_on_points<dim>(forces, boundary);
  if (air) air->add_load(step, on_points);
  on_solids = load.on_solids;
  floor = Vector<dim>::Zero();
  const std::int64_t first = boundary.water();
  on_walls.setZero(dim, boundary.first_of_bodies() - first);
  const bool several = step.ranks.several();
  Vector<dim> impulse = several ? Vector<dim>(Vector<dim>::Zero()) : state.impulse_on_walls;
  for (std::int64_t i = first; i < boundary.first_of_bodies(); ++i) {
    if (!step.ranks.owns(i)) continue;
    impulse += step.dt * forces.col(i);
    const std::int32_t master = boundary.master_of(i);
    on_walls.col((master < 0 ? i : master) - first) += forces.col(i);
    if (boundary.tank().is_floor(i)) floor += forces.col(i);
  }
  state.impulse_on_walls = several ? Vector<dim>(state.impulse_on_walls + step.ranks.sum(impulse)) : impulse;
  floor = step.ranks.sum(floor);
  for (Eigen::Index k = 0; k < on_points.cols(); ++k) state.impulse_on_bodies += step.dt * on_points.col(k);
}

/// On several ranks each adds its own layer particles.
template <int dim>
std::array<double, 2> Simulation<dim>::Work::load_on_walls(const Eigen::Vector3d& at, double reach) const {
  const Boundary<dim>& boundary = step.boundary;
  double load = 0, area = 0;
  for (std::int64_t i = boundary.water(); i < boundary.first_of_bodies(); ++i) {
    if (step.state.kind[static_cast<std::size_t>(i)] != Kind::wall) continue;
    const Vector<dim> face = boundary.wall_area(step.state, i);  // into the water
    if (face.norm() == 0) continue;
    const Vector<dim> normal = face.normalized();
    Eigen::Vector3d middle = at;  // the sensor moves with the tank
    middle.template head<dim>() = boundary.tank().face_of(i);
    const double away = (middle - at).norm();
    const double part = dim == 2 ? covered_part(away, face.norm(), reach) : (away <= reach ? 1.0 : 0.0);
    load -= part * on_walls.col(i - boundary.water()).dot(normal);
    if (step.ranks.owns(i)) area += part * face.norm();
  }
  return {step.ranks.sum(load), step.ranks.sum(area)};
}

template <int dim>
void Simulation<dim>::Work::remove_lost() {
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  const std::int64_t water = boundary.water();
  bool left = false;
#pragma omp parallel for schedule(static) reduction(|| : left)
  for (std::int64_t i = 0; i < water; ++i)
    left = left || (boundary.left_domain(state.position.col(i)) && !boundary.is_removed(state, i));
  if (step.subdomain) {
    if (step.subdomain->communicator().any(left)) remove_lost_together();
    return;
  }
  if (!left) return;
  for (std::int64_t i = 0; i < water; ++i)
    if (!boundary.is_removed(state, i) && boundary.left_domain(state.position.col(i)))
      remove(i, state.lost++);
}

/// Puts particle i away from the water. Its momentum leaves the water.
template <int dim>
void Simulation<dim>::Work::remove(std::int64_t i, std::int64_t number) {
  State<dim>& state = step.state;
  state.impulse_on_walls += step.mass * state.velocity.col(i);
  state.position.col(i) = step.boundary.place_of_removed(number);
  state.velocity.col(i).setZero();
  state.pressure[i] = 0;
  step.search.invalidate();
}

/// Updates the accounts of the step. The impulses of collisions are added to the interface force when the
/// scheme conserves.
template <int dim>
void Simulation<dim>::Work::finish() {
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  if (step.subdomain) sum_collisions();
  state.impulse_of_collisions += collisions.on_water;
  state.impulse_on_walls += collisions.on_walls;
  for (Eigen::Index k = 0; k < collisions.on_points.cols(); ++k) {
    state.impulse_on_bodies += collisions.on_points.col(k);
    if (step.p.scheme.collision_conserve) on_points.col(k) += collisions.on_points.col(k) / step.dt;
  }
  force = boundary.on_mesh(on_points);
  const std::int64_t water = boundary.water();
  std::int64_t inner = 0;
  double fastest = 0;
#pragma omp parallel for schedule(static) reduction(+ : inner) reduction(max : fastest)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!step.ranks.owns(i)) continue;
    fastest = std::max(fastest, state.velocity.col(i).squaredNorm());
    inner += state.surface[static_cast<std::size_t>(i)] ? 0 : 1;
  }
  inner = step.ranks.sum(inner);
  fastest = step.ranks.max(fastest);
  const std::int64_t whole_water = step.subdomain ? step.subdomain->water_of_whole() : water;
  state.inner_fraction_min =
      std::min(state.inner_fraction_min,
               static_cast<double>(inner) / static_cast<double>(std::max<std::int64_t>(1, whole_water)));
  state.penetrations = std::max(state.penetrations, collisions.inside);
  state.behind_walls += collisions.behind_walls;
  report.cfl = std::sqrt(fastest) * step.dt / step.p.spacing;
  state.time += step.dt;
  ++state.step;
}

#define STRAKE_INSTANTIATE(dim)                                                                              \
  template void Simulation<dim>::Work::take_load(Load<dim>);                                                 \
  template std::array<double, 2> Simulation<dim>::Work::load_on_walls(const Eigen::Vector3d&, double) const; \
  template void Simulation<dim>::Work::remove_lost();                                                        \
  template void Simulation<dim>::Work::remove(std::int64_t, std::int64_t);                                   \
  template void Simulation<dim>::Work::finish();
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
