#include "fluid/mps/interface_load.hpp"
#include "fluid/simulation/step.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

// What a step gives to others and keeps account of: loads, faults, lost particles, momentum.

namespace strake::fluid {

template <int dim>
void Simulation<dim>::Work::load_interface() {
  const StageClock clock(seconds, "load");
  RowForces<dim> forces;
  if (fitted) {
    forces = fitted->row_forces(boundary, state, near_gradient());
    const auto rows = forces.cols() - boundary.water();
    forces.rightCols(rows) += mass * viscous.acceleration.rightCols(rows);
  } else {
    const LoadTerms<dim> terms{viscous.acceleration,
                               gravity,
                               motion->acceleration,
                               p.scheme.gradient,
                               gradient_lattice,
                               p.density,
                               p.spacing,
                               &level};
    forces = row_forces<dim>(state, boundary, near_gradient(), terms);
  }
  on_points = gather_on_points<dim>(forces, boundary);
  if (boundary.volume()) {
    const auto solids = state.pressure.tail(state.pressure.size() - boundary.first_of_bodies());
    if (p.scheme.gradient == Gradient::pairwise) {
      carried = carried_pressure<dim>(state, boundary, near_gradient(), gradient_lattice);
    } else {
      carried.setOnes(2, solids.size());
      carried.row(0) = solids.transpose();
    }
  }
  floor = Vector<dim>::Zero();
  const std::int64_t first = boundary.water();
  on_walls.setZero(dim, boundary.first_of_bodies() - first);
  for (std::int64_t i = first; i < boundary.first_of_bodies(); ++i) {
    state.impulse_on_walls += dt * forces.col(i);
    const std::int32_t master = boundary.master_of(i);
    on_walls.col((master < 0 ? i : master) - first) += forces.col(i);
    if (boundary.tank().is_floor(i)) floor += forces.col(i);
  }
  for (Eigen::Index k = 0; k < on_points.cols(); ++k) state.impulse_on_bodies += dt * on_points.col(k);
}

template <int dim>
std::string Simulation<dim>::Work::where() const {
  return fmt::format("fluid, step {} (t = {:.9g} s)", state.step, state.time);
}

template <int dim>
void Simulation<dim>::Work::check_finite() const {
  const std::int64_t water = boundary.water();
  bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite)
  for (std::int64_t i = 0; i < water; ++i)
    finite = finite && (state.position.col(i).array() - state.position.col(i).array() == 0).all() &&
             (state.velocity.col(i).array() - state.velocity.col(i).array() == 0).all();
  if (finite) return;
  for (std::int64_t i = 0; i < water; ++i) {
    if (state.position.col(i).allFinite() && state.velocity.col(i).allFinite()) continue;
    throw Error(
        ExitCode::solver_fault, where(),
        fmt::format("particle {} is no longer finite: position ({:.6g}, {:.6g}), velocity ({:.6g}, {:.6g})",
                    state.id[static_cast<std::size_t>(i)], state.position(0, i), state.position(1, i),
                    state.velocity(0, i), state.velocity(1, i)),
        "reduce fluid.scheme.time_step or fluid.scheme.cfl");
  }
}

template <int dim>
void Simulation<dim>::Work::park_lost() {
  const std::int64_t water = boundary.water();
  bool left = false;
#pragma omp parallel for schedule(static) reduction(|| : left)
  for (std::int64_t i = 0; i < water; ++i)
    left = left || (boundary.left_domain(state.position.col(i)) && !boundary.parked(state, i));
  if (!left) return;
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.parked(state, i) || !boundary.left_domain(state.position.col(i))) continue;
    state.impulse_on_walls += mass * state.velocity.col(i);  // it takes its momentum out of the account
    state.position.col(i) = boundary.parking_place(state.lost++);
    state.velocity.col(i).setZero();
    state.pressure[i] = 0;
    search.invalidate();
  }
}

/// Accounts of the step; the load of collisions joins the interface force when the scheme conserves.
template <int dim>
void Simulation<dim>::Work::finish() {
  state.impulse_of_collisions += collisions.on_water;
  state.impulse_on_walls += collisions.on_walls;
  for (Eigen::Index k = 0; k < collisions.on_points.cols(); ++k) {
    state.impulse_on_bodies += collisions.on_points.col(k);
    if (p.scheme.collision_conserve) on_points.col(k) += collisions.on_points.col(k) / dt;
  }
  force = boundary.on_mesh(on_points);
  const std::int64_t water = boundary.water();
  std::int64_t inner = 0;
  double fastest = 0;
#pragma omp parallel for schedule(static) reduction(+ : inner) reduction(max : fastest)
  for (std::int64_t i = 0; i < water; ++i) {
    fastest = std::max(fastest, state.velocity.col(i).squaredNorm());
    inner += state.surface[static_cast<std::size_t>(i)] ? 0 : 1;
  }
  state.inner_fraction_min =
      std::min(state.inner_fraction_min,
               static_cast<double>(inner) / static_cast<double>(std::max<std::int64_t>(1, water)));
  state.penetrations = std::max(state.penetrations, collisions.inside);
  state.behind_walls += collisions.behind_walls;
  report.cfl = std::sqrt(fastest) * dt / p.spacing;
  state.time += dt;
  ++state.step;
}

#define STRAKE_INSTANTIATE(dim)                              \
  template void Simulation<dim>::Work::load_interface();     \
  template std::string Simulation<dim>::Work::where() const; \
  template void Simulation<dim>::Work::check_finite() const; \
  template void Simulation<dim>::Work::park_lost();          \
  template void Simulation<dim>::Work::finish();
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
