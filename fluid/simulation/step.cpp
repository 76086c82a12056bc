#include "fluid/simulation/step.hpp"

#include "fluid/boundary/body_packing.hpp"
#include "fluid/particles/reorder.hpp"
#include "fluid/scheme/stage_clock.hpp"
#include "fluid/simulation/make_scheme.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace strake::fluid {

namespace {

/// Interpolates the velocity of the partner's points to the fluid's own points, at the nearest place of the
/// partner's faces.
Points velocity_on(const InterfaceMesh& mesh, const InterfaceMesh& partner, const Points& velocity) {
  const bool same = partner.faces.cols() == 0 || mesh.dimension == 3;  // points of both meshes
  if (velocity.cols() == mesh.position.cols() && same) return velocity;
  Points on_mesh = Points::Zero(3, mesh.position.cols());
  if (velocity.cols() != partner.position.cols()) return on_mesh;
  for (Eigen::Index k = 0; k < mesh.position.cols(); ++k) {
    double best = std::numeric_limits<double>::infinity();
    for (Eigen::Index f = 0; f < partner.faces.cols(); ++f) {
      const int a = partner.faces(0, f), b = partner.faces(1, f);
      const Eigen::Vector3d t = partner.position.col(b) - partner.position.col(a);
      const double s =
          std::clamp((mesh.position.col(k) - partner.position.col(a)).dot(t) / t.squaredNorm(), 0.0, 1.0);
      const double distance = (partner.position.col(a) + s * t - mesh.position.col(k)).squaredNorm();
      if (distance >= best) continue;
      best = distance;
      on_mesh.col(k) = (1 - s) * velocity.col(a) + s * velocity.col(b);
    }
  }
  return on_mesh;
}

}  // namespace

template <int dim>
Simulation<dim>::Work::Work(const Parameters& p, const InterfaceMesh& partner, const Points& initial_velocity,
                            const Ranks& ranks)
    : step(p, partner, initial_velocity, pair_data(p.scheme), ranks),
      scheme(make_scheme<dim>(step)),
      poisson(step.laplacian_lattice.radius) {
  omp_set_num_threads(p.threads);
  State<dim>& state = step.state;
  Boundary<dim>& boundary = step.boundary;
  const auto m = boundary.mesh().position.cols();
  force = Points::Zero(3, m);
  on_points = Vectors<dim>::Zero(dim, boundary.points());
  if (m > 0)
    boundary.move(state, Points::Zero(3, m), velocity_on(boundary.mesh(), partner, initial_velocity), true);
  for (std::int64_t i = 0; i < boundary.water(); ++i)
    state.initial_momentum += step.mass * state.velocity.col(i);
  begin_at_rest<dim>(p, boundary, state);
  if (p.air.layer) air = std::make_unique<AirUnderBody<dim>>(p.air, step);
  const bool several = ranks.communicator != nullptr && ranks.communicator->size() > 1;
  // A rank needs no memory for the whole water, but where its start is measured.
  if (!several || water_starts_packed(p, boundary)) scheme->begin(step);
  if (several) begin_on_ranks(ranks);
}

/// Sets the gravity of a step, and the velocity of bodies and tank at its end. During the ramp gravity is
/// g · ½(1 − cos(πt/ramp)) at the middle of the step.
template <int dim>
void Simulation<dim>::Work::begin(double dt, double rest, double stable, const InterfaceMotion& given) {
  State<dim>& state = step.state;
  step.substepping.step(dt, rest, scheme->may_substep(step, dt) ? stable : 0, state.step);
  step.dt = dt;
  step.motion = &given;
  double ramp = 1;
  const double t = state.time + 0.5 * dt;
  if (step.p.gravity_ramp > 0 && t < step.p.gravity_ramp)
    ramp = 0.5 * (1 - std::cos(std::numbers::pi * t / step.p.gravity_ramp));
  step.gravity = ramp * step.p.gravity.template head<dim>();
  // In volume coupling the structure's particles are placed for this step. In surface coupling only their
  // velocity at the step's end is set.
  step.boundary.move(state, given.displacement, given.velocity, step.boundary.volume());
  step.boundary.move_tank(state, state.time + dt, false);
}

template <int dim>
void Simulation<dim>::Work::measure() {
  {
    const StageClock clock(step.seconds, step.subdomain ? "division" : "neighbours",
                           step.ranks.communicator());
    sort_along_cells();
  }
  {
    const StageClock clock(step.seconds, "neighbours", step.ranks.communicator());
    step.search_neighbours();
  }
  if (air) air->give_over(step);
  find_stresses();
  scheme->measure(step);
}

/// Sorts the water along the cells every fifty steps, so that neighbours in space are neighbours in memory.
/// On several ranks it is divided anew and balanced there, and divided wherever a particle leaves its bucket.
template <int dim>
void Simulation<dim>::Work::sort_along_cells() {
  const bool due = reorder_due(step.state.step);
  if (step.subdomain) {
    if (step.subdomain->is_read()) divide(false);
    if (due) step.subdomain->sort_along_cells(step.state, step.search.reach());
    if (due || step.subdomain->is_due(step.state))
      divide(due);
    else
      step.subdomain->refresh(step.state);
    return;
  }
  if (!due) return;
  const auto water = step.state.position.leftCols(step.boundary.water());
  reorder(step.state, cell_order<dim>(water, step.search.reach()));
  step.search.invalidate();
}

/// Computes ν∇²u + ∇·τ.
template <int dim>
void Simulation<dim>::Work::find_stresses() {
  const StageClock clock(step.seconds, "predictor", step.ranks.communicator());
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  const std::int64_t water = boundary.water();
  // A dry face carries no stress, because air is between it and the water.
  wet.assign(state.kind.size(), 1);
  for (std::int64_t i = boundary.first_of_bodies(); i < static_cast<std::int64_t>(wet.size()); ++i) {
    const std::int32_t first = boundary.master_of(i);
    if (state.surface[static_cast<std::size_t>(first < 0 ? i : first)]) wet[static_cast<std::size_t>(i)] = 0;
  }
  describe_layers<dim>(boundary, state, step.p.wall == WallSlip::free_slip, step.p.spacing, walls);
  if (step.p.scheme.wall_damping) {
    wall_distance.resize(static_cast<std::size_t>(water));
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < water; ++i)
      wall_distance[static_cast<std::size_t>(i)] = boundary.tank().distance(state.position.col(i));
  }
  const auto spare = scheme->spare_memory();
  viscous.exchange(spare.tensors, spare.shared, poisson.memory());
  viscous.compute(step.p,
                  {state.position, state.velocity, step.near_gradient(), *step.far, walls, wet, state.surface,
                   step.search.periodic(), wall_distance, step.ranks},
                  step.substepping.length(), state.sps_k);
  viscous.exchange(spare.tensors, spare.shared, poisson.memory());
  step.viscous = &viscous.acceleration;
}

template <int dim>
void Simulation<dim>::Work::advance_air() {
  if (air) air->advance(step);
}

/// Whether the water may have parts without free surface and without compressibility.
template <int dim>
bool Simulation<dim>::Work::may_be_sealed() const {
  return !(std::isfinite(step.p.sound_speed) && std::isinf(step.p.sound_depth));
}

template <int dim>
typename Simulation<dim>::Work::Solved Simulation<dim>::Work::solve_alone() {
  const bool sealed = may_be_sealed() && close_sealed_blocks(system) > 0;
  guess.resize(system.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < system.size(); ++k)
    guess[k] = step.state.pressure[system.particle[static_cast<std::size_t>(k)]];
  return {poisson.solve(system, step.state.position, guess, step.p.scheme), sealed};
}

template <int dim>
void Simulation<dim>::Work::solve_pressure() {
  const StageClock clock(step.seconds, "pressure", step.ranks.communicator());
  const Scheme& keys = step.p.scheme;
  State<dim>& state = step.state;
  scheme->assemble(step, system);
  const Solved solved = step.subdomain ? solve_together() : solve_alone();
  const PressureSolution& solution = solved.solution;
  report.pressure_iterations = solution.iterations;
  const bool failed = !(solution.residual <= 10 * keys.pressure_tolerance) || !solution.pressure.allFinite();
  if (step.ranks.any(failed))  // the ranks agree
    throw Error(
        ExitCode::solver_fault, step.where(),
        fmt::format("the pressure equation did not converge: {} iterations, residual {:.3g} (asked {:.3g}), "
                    "CFL {:.3g}, {} unknowns",
                    solution.iterations, solution.residual, keys.pressure_tolerance, report.cfl,
                    system.size()),
        "reduce fluid.scheme.time_step, or raise fluid.scheme.pressure.max_iterations or .tolerance");
  state.pressure.setZero();
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < system.size(); ++k)
    state.pressure[system.particle[static_cast<std::size_t>(k)]] = solution.pressure[k];
  // In a closed tank the pressure has no fixed zero, and tension has no meaning.
  scheme->limit_pressure(step, keys.negative_pressure || !step.p.open_top || solved.sealed);
}

template <int dim>
void Simulation<dim>::Work::correct() {
  {
    const StageClock clock(step.seconds, "corrector", step.ranks.communicator());
    scheme->find_gradient(step);
  }
  {
    const StageClock clock(step.seconds, "load", step.ranks.communicator());
    take_load(scheme->load(step));
  }
  const StageClock clock(step.seconds, "corrector", step.ranks.communicator());
  report.divergence_max = scheme->correct(step);
}

template <int dim>
void Simulation<dim>::Work::shift() {
  const StageClock clock(step.seconds, "shift", step.ranks.communicator());
  step.check_finite();
  collisions = {};
  if (!step.substepping.is_over()) return;
  scheme->shift(step);
  collisions = separate_particles<dim>(step.state, step.boundary, step.near_density(), step.p.scheme,
                                       step.substepping.age(), step.p.spacing, step.mass, colliding_ranks());
  remove_lost();
  step.boundary.tank().wrap(step.state);
}

template struct Simulation<2>::Work;
template struct Simulation<3>::Work;

}  // namespace strake::fluid
