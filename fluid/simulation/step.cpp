#include "fluid/simulation/step.hpp"

#include "fluid/boundary/submerged.hpp"
#include "fluid/diagnostics/voids.hpp"
#include "fluid/mps/correction.hpp"
#include "fluid/mps/interface_load.hpp"
#include "fluid/mps/lattice_filter.hpp"
#include "fluid/mps/number_density.hpp"
#include "fluid/mps/operators.hpp"
#include "fluid/particles/reorder.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace strake::fluid {

namespace {

/// Verlet skin [l0].
constexpr double skin = 0.2;

/// The joint stress and the fitted scheme read the rows of the largest radius as the matrix of the pressure
/// alone.
bool keeps_entries(const Scheme& scheme) {
  return scheme.gradient == Gradient::least_squares && scheme.sps == SpsForm::joint;
}

/// Velocity of the partner's points at the fluid's own, by the nearest point of the partner's faces.
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
Simulation<dim>::Work::Work(const Parameters& parameters, const InterfaceMesh& partner,
                            const Points& initial_velocity)
    : p(parameters),
      density_lattice(lattice_constants<dim>(p.scheme.radius_density, p.spacing)),
      gradient_lattice(lattice_constants<dim>(p.scheme.radius_gradient, p.spacing)),
      divergence_lattice(lattice_constants<dim>(p.scheme.radius_divergence, p.spacing)),
      laplacian_lattice(lattice_constants<dim>(p.scheme.radius_laplacian, p.spacing)),
      mass(p.density * std::pow(p.spacing, dim)),
      state(fill_around<dim>(p, partner)),
      boundary(p, partner, initial_velocity, state),
      search(std::max({density_lattice.radius, gradient_lattice.radius, divergence_lattice.radius,
                       laplacian_lattice.radius}),
             skin * p.spacing, boundary.tank().periodic(),
             keeps_entries(p.scheme) ? PairData::entries : PairData::inverses) {
  omp_set_num_threads(p.threads);
  const auto m = boundary.mesh().position.cols();
  force = Points::Zero(3, m);
  on_points = Vectors<dim>::Zero(dim, boundary.points());
  if (dim == 3 && m > 0 && !boundary.volume() && p.scheme.gradient != Gradient::least_squares)
    throw Error(ExitCode::case_file, "fluid.scheme.gradient",
                "moving surfaces in three dimensions are built for least-squares alone",
                "set fluid.scheme.gradient = \"least-squares\", or fluid.dimension = 2");
  if (m > 0)
    boundary.move(state, Points::Zero(3, m), velocity_on(boundary.mesh(), partner, initial_velocity), true);
  for (std::int64_t i = 0; i < boundary.water(); ++i) state.initial_momentum += mass * state.velocity.col(i);
  state.surface.assign(state.kind.size(), 1);
  if (p.scheme.gradient == Gradient::least_squares && boundary.volume())
    throw Error(ExitCode::case_file, "fluid.scheme.gradient",
                "least-squares has no volume coupling: the structure's particles are no faces",
                "set fluid.scheme.gradient = \"pairwise\"");
  if (p.scheme.gradient == Gradient::least_squares)
    fitted = std::make_unique<FittedScheme<dim>>(p, boundary, state);
  moves.assign(state.kind.size(), 0);
  std::fill_n(moves.begin(), boundary.water(), std::uint8_t{1});
}

/// Before every fiftieth step: what is near in space comes near in memory.
template <int dim>
void Simulation<dim>::Work::sort_along_cells() {
  if (!reorder_due(state.step)) return;
  const StageClock clock(seconds, "neighbours");
  const auto water = state.position.leftCols(boundary.water());
  reorder(state, cell_order<dim>(water, search.reach()));
  search.invalidate();
}

/// g · ½(1 − cos(πt/ramp)) in the middle of the step; the bodies' velocity of the end of the step.
template <int dim>
void Simulation<dim>::Work::begin(double step, const InterfaceMotion& given) {
  dt = step;
  motion = &given;
  double ramp = 1;
  const double t = state.time + 0.5 * dt;
  if (p.gravity_ramp > 0 && t < p.gravity_ramp)
    ramp = 0.5 * (1 - std::cos(std::numbers::pi * t / p.gravity_ramp));
  gravity = ramp * p.gravity.head<dim>();
  // Volume coupling gives the places of the structure's particles for this step, surface coupling those at
  // its end.
  boundary.move(state, given.displacement, given.velocity, boundary.volume());
  boundary.move_tank(state, state.time + dt, false);
}

template <int dim>
void Simulation<dim>::Work::search_neighbours() {
  const auto keep = [this](std::int32_t i, std::int32_t j) { return boundary.keep(state, i, j); };
  far = &search.update(state.position, boundary.tags(state), keep);
}

template <int dim>
void Simulation<dim>::Work::find_neighbours() {
  const StageClock clock(seconds, "neighbours");
  search_neighbours();
}

/// ν∇²u + ∇·τ.
template <int dim>
void Simulation<dim>::Work::find_stresses() {
  const StageClock clock(seconds, "predictor");
  const std::int64_t water = boundary.water();
  // Air between a dry face and the water carries no stress.
  wet.assign(state.kind.size(), 1);
  for (std::int64_t i = boundary.first_of_bodies(); i < static_cast<std::int64_t>(wet.size()); ++i) {
    const std::int32_t first = boundary.master_of(i);
    if (state.surface[static_cast<std::size_t>(first < 0 ? i : first)]) wet[static_cast<std::size_t>(i)] = 0;
  }
  describe_rows<dim>(boundary, state, p.wall == WallSlip::free_slip, p.spacing, walls);
  if (p.scheme.wall_damping) {
    wall_distance.resize(static_cast<std::size_t>(water));
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < water; ++i)
      wall_distance[static_cast<std::size_t>(i)] = boundary.tank().distance(state.position.col(i));
  }
  // Both write theirs anew before they read it, one after the other.
  if (fitted) viscous.exchange(fitted->tensors(), fitted->memory(), poisson.memory());
  viscous.compute(p,
                  {state.position, state.velocity, near_gradient(), *far, walls, wet, state.surface,
                   search.periodic(), wall_distance},
                  hold.length(), state.sps_k);
  if (fitted) viscous.exchange(fitted->tensors(), fitted->memory(), poisson.memory());
}

/// u* = u + Δt (ν∇²u + ∇·τ + g); r* = r + Δt u* where the scheme works at r* (fluid/THEORY.md (F30)).
template <int dim>
void Simulation<dim>::Work::predict() {
  const StageClock clock(seconds, "predictor");
  const std::int64_t water = boundary.water();
  if (p.scheme.gradient == Gradient::pairwise) filter_velocity();
  std::int64_t pulled = 0;
#pragma omp parallel for schedule(static) reduction(+ : pulled)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.parked(state, i)) continue;
    state.velocity.col(i) += dt * (viscous.acceleration.col(i) + gravity);
    ++pulled;
  }
  state.impulse_of_gravity += static_cast<double>(pulled) * mass * dt * gravity;
  if (!at_star()) return;
  state.position.leftCols(water) += dt * state.velocity.leftCols(water);
  if (!boundary.volume()) boundary.move(state, motion->displacement, motion->velocity, true);
  boundary.move_tank(state, state.time + dt, true);
}

template <int dim>
void Simulation<dim>::Work::filter_velocity() {
  const Vectors<dim> change =
      filter_lattice<dim>({state.position, state.velocity, state.pressure, near_gradient(), gradient_lattice,
                           boundary.water(), p.scheme.filter, p.density, p.spacing, dt});
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < change.cols(); ++i)
    if (!boundary.parked(state, i)) state.velocity.col(i) += change.col(i);
}

template <int dim>
void Simulation<dim>::Work::measure_number_density() {
  const StageClock clock(seconds, "density");
  if (fitted) {
    fitted->measure(boundary, state, *far, near_gradient());
    return follow_air(state, near_gradient(), boundary.water(), newly_aired);
  }
  if (at_star()) {
    check_finite();
    search_neighbours();
  }
  const Neighbours& near = near_density();
  n = number_density(near, density_lattice.radius);
  boundary.count_water(state, near, density_lattice, n);
  const SurfaceTest test{p.scheme.beta, p.scheme.second, p.spacing, density_lattice};
  std::vector<std::uint8_t> flags =
      surface_flags<dim>(state.position, state.kind, near, n, test, state.surface);
  boundary.hold_apart(state, near, state.surface, flags);
  state.surface.swap(flags);
  follow_air(state, near, boundary.water(), newly_aired);
  classify_rows();
}

/// Whether a structure particle that its fellows surrounded stands at a crack by now: so many of them are
/// gone as a face lacks. Strain takes less, 1 % of it no more than 3 %; a second row at a crack lacks 2 %,
/// the face itself 15 % from an opening of 0.35 l0 on and 35 to 40 % in the end.
template <int dim>
bool Simulation<dim>::Work::laid_bare(std::int64_t i, const Neighbours& near) const {
  constexpr double left = 0.85;
  const auto columns = near.row(i);
  const auto distances = near.distances(i);
  double fellows = 0;
  for (std::size_t e = 0; e < columns.size(); ++e)
    if (columns[e] >= boundary.first_of_bodies() && distances[e] < density_lattice.radius)
      fellows += weight(distances[e], density_lattice.radius);
  return fellows < left * density_lattice.n0;
}

/// Unknowns are particles with a pressure that are not surface; δ = (n − n0)/n0, where a negative value
/// beside the surface is no expansion but missing neighbours, and would suck (fluid/THEORY.md, section 5).
template <int dim>
void Simulation<dim>::Work::classify_rows() {
  const Neighbours& near = near_density();
  const auto count = static_cast<std::int64_t>(state.kind.size());
  row.assign(state.kind.size(), Row::none);
  solved.assign(state.kind.size(), 0);
  deviation.setZero(count);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!has_pressure(state.kind[k]) || boundary.parked(state, i)) continue;
    if (boundary.buried(i) && !laid_bare(i, near)) continue;
    row[k] = state.surface[k] ? Row::zero : Row::unknown;
    if (state.surface[k]) continue;
    solved[k] = 1;
    // A structure particle keeps its own density whatever the water does.
    if (state.kind[k] == Kind::solid) continue;
    double delta = n[i] / density_lattice.n0 - 1;
    if (delta < 0)
      for (const std::int32_t j : near.row(i))
        if (state.surface[static_cast<std::size_t>(j)]) {
          delta = 0;
          break;
        }
    deviation[i] = delta;
  }
}

template <int dim>
void Simulation<dim>::Work::assemble() {
  if (fitted) {
    fitted->filter(boundary, state, near_gradient(), dt, hold);
    return fitted->assemble(boundary, state, *far, gravity - boundary.tank().acceleration(), dt, system);
  }
  divergence =
      fluid::divergence<dim>(state.position, state.velocity, search.within(divergence_lattice.radius),
                             divergence_lattice, Masks{solved, {}});
  const PressureTerms terms{row,       divergence,    deviation, state.pressure, boundary.solid_density(),
                            p.density, p.sound_speed, dt};
  assemble_pressure<dim>(*far, terms, p.scheme, laplacian_lattice, system);
}

template <int dim>
void Simulation<dim>::Work::solve_pressure() {
  const StageClock clock(seconds, "pressure");
  const Scheme& scheme = p.scheme;
  assemble();
  const bool sealed =
      !(std::isfinite(p.sound_speed) && std::isinf(p.sound_depth)) && close_sealed_blocks(system) > 0;
  guess.resize(system.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < system.size(); ++k)
    guess[k] = state.pressure[system.particle[static_cast<std::size_t>(k)]];
  const PressureSolution& solution = poisson.solve(system, state.position, guess, scheme);
  report.pressure_iterations = solution.iterations;
  if (!(solution.residual <= 10 * scheme.pressure_tolerance) || !solution.pressure.allFinite())
    throw Error(
        ExitCode::solver_fault, where(),
        fmt::format("the pressure equation did not converge: {} iterations, residual {:.3g} (asked {:.3g}), "
                    "CFL {:.3g}, {} unknowns",
                    solution.iterations, solution.residual, scheme.pressure_tolerance, report.cfl,
                    system.size()),
        "reduce fluid.scheme.time_step, or raise fluid.scheme.pressure.max_iterations or .tolerance");
  state.pressure.setZero();
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < system.size(); ++k)
    state.pressure[system.particle[static_cast<std::size_t>(k)]] = solution.pressure[k];
  // In a closed tank pressure has no zero that tension could be measured from.
  if (!scheme.negative_pressure && p.open_top && !sealed) {
    if (fitted)
      fitted->release_tension(boundary, state, *far);
    else
      state.pressure = state.pressure.cwiseMax(0.0);
  }
  if (fitted) fitted->limit(boundary, state, near_gradient());
  if (!fitted) boundary.fill_dummies(state, gravity, motion->acceleration);
}

/// u = u* − (Δt/ρ)∇p (F31); r = r* + Δt (u − u*) (F32), or rⁿ + Δt u where the scheme works at rⁿ: both
/// say r = rⁿ + Δt u, which adds no energy to the lattice's own oscillation; the mean of uⁿ and u would.
template <int dim>
void Simulation<dim>::Work::correct() {
  if (fitted) return correct_fitted();
  {
    const StageClock clock(seconds, "corrector");
    if (p.scheme.gradient == Gradient::pairwise)
      level = face_level<dim>(state, boundary, near_gradient(), gradient_lattice, p.spacing);
    gradient = pressure_gradient<dim>(state, boundary, near_gradient(), gradient_lattice, p.scheme.gradient,
                                      Masks{moves, {}}, level);
  }
  load_interface();  // belongs to the places the pressure was solved for
  const StageClock clock(seconds, "corrector");
  const std::int64_t water = boundary.water();
  Vectors<dim> change = -dt / p.density * gradient.leftCols(water);
  for (std::int64_t i = 0; i < water; ++i)
    if (boundary.parked(state, i)) change.col(i).setZero();
  state.velocity.leftCols(water) += change;
  divergence =
      fluid::divergence<dim>(state.position, state.velocity, search.within(divergence_lattice.radius),
                             divergence_lattice, Masks{solved, {}});
  report.divergence_max = divergence.head(water).cwiseAbs().maxCoeff();
  if (at_star())
    state.position.leftCols(water) += dt * change;
  else
    state.position.leftCols(water) += dt * state.velocity.leftCols(water);
  if (!at_star() && !boundary.volume()) boundary.move(state, motion->displacement, motion->velocity, true);
  if (!at_star()) boundary.move_tank(state, state.time + dt, true);
  hold.ends(0, 0, p.spacing);
}

template <int dim>
void Simulation<dim>::Work::shift() {
  const StageClock clock(seconds, "shift");
  check_finite();
  collisions = {};
  if (!hold.is_over()) return;
  if (fitted)
    fitted->shift(boundary, state, near_gradient(), hold.age());
  else
    shift_particles<dim>(state, boundary, near_gradient(), gradient_lattice, p.scheme.shifting,
                         std::sqrt(p.gravity.norm() * p.spacing), dt, p.spacing);
  collisions =
      separate_particles<dim>(state, boundary, near_density(), p.scheme, hold.age(), p.spacing, mass);
  park_lost();
  boundary.tank().wrap(state);
}

template struct Simulation<2>::Work;
template struct Simulation<3>::Work;

}  // namespace strake::fluid
