#include "fluid/scheme/step_data.hpp"

#include "fluid/boundary/body_packing.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/boundary/submerged.hpp"
#include "proto/error.hpp"
#include "proto/ranks/agreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {

namespace {

/// Verlet skin [l0].
constexpr double skin = 0.2;
/// Part of a pair's length by which a way around a corner must be longer, to count as one.
constexpr double round_off = 1e-6;

}  // namespace

template <int dim>
StepData<dim>::StepData(const Parameters& parameters, const InterfaceMesh& partner,
                        const Points& initial_velocity, PairData pair_data, const Ranks& all)
    : p(parameters),
      density_lattice(lattice_constants<dim>(p.scheme.radius_density, p.spacing)),
      gradient_lattice(lattice_constants<dim>(p.scheme.radius_gradient, p.spacing)),
      divergence_lattice(lattice_constants<dim>(p.scheme.radius_divergence, p.spacing)),
      laplacian_lattice(lattice_constants<dim>(p.scheme.radius_laplacian, p.spacing)),
      mass(p.density * std::pow(p.spacing, dim)),
      state(start(partner, all)),
      boundary(p, partner, initial_velocity, state),
      search(std::max({density_lattice.radius, gradient_lattice.radius, divergence_lattice.radius,
                       laplacian_lattice.radius}),
             skin * p.spacing, boundary.tank().periodic(), pair_data) {
  if (shared_water > 0)
    on_all_ranks(*all.communicator, [&] { boundary.check_overlap(state); });
  else
    boundary.check_overlap(state);
  pack_around<dim>(p, boundary, state);
}

/// Returns the particles at the start. A rank makes its share of the water alone. Packed water is made as a
/// whole, and that of a tank that moves.
template <int dim>
State<dim> StepData<dim>::start(const InterfaceMesh& partner, const Ranks& all) {
  const bool has_body = partner.position.cols() > 0,
             several = all.communicator && all.communicator->size() > 1;
  if (!several || (p.submerged && has_body) || p.motion.moves() || !TankShape<dim>(p).on_lattice() ||
      p.scheme.gradient != Gradient::least_squares)
    return fill_around<dim>(p, partner);
  WaterShare<dim> share = fill_share<dim>(p, all.communicator->rank(), all.communicator->size());
  shared_water = share.water_of_whole;
  return std::move(share.state);
}

template <int dim>
void StepData<dim>::search_neighbours() {
  const bool around = p.scheme.gradient == Gradient::least_squares && !boundary.body_surface().empty();
  const auto keep = [&](std::int32_t i, std::int32_t j) { return boundary.keep(state, i, j, around); };
  far = &search.update(state.position, boundary.tags(state, ranks.owned(), ranks.absent_layers()), keep);
  if (around) lengthen_around_corners();
}

/// Gives pairs that a corner comes between the length of the way around it. It grows from the straight one,
/// so that the pair's weights fade. A weight that ends at once would change ∇·u at once.
template <int dim>
void StepData<dim>::lengthen_around_corners() {
  const std::int64_t water = boundary.water();
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    if (!boundary.beside_corner(state, i)) continue;
    const auto row = far->row(i);
    const std::int64_t first = far->start()[static_cast<std::size_t>(i)];
    for (std::size_t e = 0; e < row.size() && row[e] < water; ++e) {
      const auto pair = first + static_cast<std::int64_t>(e);
      const double way = boundary.way_around(state, i, row[e]);
      if (way > (1 + round_off) / far->inverse_of(pair)) search.lengthen(pair, way);
    }
  }
}

template <int dim>
void StepData<dim>::accelerate() {
  const std::int64_t water = boundary.water();
  std::int64_t accelerated = 0;
#pragma omp parallel for schedule(static) reduction(+ : accelerated)
  for (std::int64_t i = 0; i < water; ++i) {
    if (boundary.is_removed(state, i) || !ranks.owns(i)) continue;
    state.velocity.col(i) += dt * (viscous->col(i) + gravity);
    ++accelerated;
  }
  ranks.update(state.velocity);
  state.impulse_of_gravity += static_cast<double>(ranks.sum(accelerated)) * mass * dt * gravity;
}

template <int dim>
void StepData<dim>::move_boundaries() {
  if (!boundary.volume()) boundary.move(state, motion->displacement, motion->velocity, true);
  boundary.move_tank(state, state.time + dt, true);
}

template <int dim>
std::string StepData<dim>::where() const {
  return fmt::format("fluid, step {} (t = {:.9g} s)", state.step, state.time);
}

template <int dim>
void StepData<dim>::check_finite() const {
  const std::int64_t water = boundary.water();
  bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite)
  for (std::int64_t i = 0; i < water; ++i)
    if (ranks.owns(i))
      finite = finite && (state.position.col(i).array() - state.position.col(i).array() == 0).all() &&
               (state.velocity.col(i).array() - state.velocity.col(i).array() == 0).all();
  if (ranks.max(finite ? 0 : 1) == 0) return;  // the ranks agree
  for (std::int64_t i = 0; i < water; ++i) {
    if (!ranks.owns(i)) continue;
    if (state.position.col(i).allFinite() && state.velocity.col(i).allFinite()) continue;
    throw Error(
        ExitCode::solver_fault, where(),
        fmt::format("particle {} is no longer finite: position ({:.6g}, {:.6g}), velocity ({:.6g}, {:.6g})",
                    state.id[static_cast<std::size_t>(i)], state.position(0, i), state.position(1, i),
                    state.velocity(0, i), state.velocity(1, i)),
        "reduce fluid.scheme.time_step or fluid.scheme.cfl");
  }
  throw Error(ExitCode::solver_fault, where(), "a particle of another rank is no longer finite",
              "reduce fluid.scheme.time_step or fluid.scheme.cfl");
}

template struct StepData<2>;
template struct StepData<3>;

}  // namespace strake::fluid
