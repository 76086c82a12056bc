#include "fluid/simulation/step.hpp"
#include "proto/error.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

// One fluid on several ranks. Before each configuration water that has crossed a bound moves to another rank,
// and the ghosts are renewed. Between, each rank computes its own particles and its ghosts. The ranks solve
// the pressure equation together, or the first one solves it as a whole.

namespace strake::fluid {

namespace {

/// Row of the pressure equation in a message; its entries follow.
struct RowHead {
  std::int64_t place, count;  // in the whole, number of entries
  double diagonal, right, guess;
  double position[3];
};
struct RowEntry {
  std::int32_t column;
  float value;
};
/// What the first rank tells of a solution; the pressures follow.
struct SolutionHead {
  double residual;
  std::int32_t iterations, sealed;
};

/// Packs the rows of the own water.
template <int dim>
Bytes packed_rows(const PressureSystem& system, const Subdomain<dim>& own, const State<dim>& state) {
  Bytes bytes;
  const auto& places = own.division().place;
  for (std::int64_t k = 0; k < system.size(); ++k) {
    if (!own.owns(k)) continue;
    const auto row = static_cast<std::size_t>(k);
    RowHead head{places[row],        system.stop[row] - system.start[row],
                 system.diagonal[k], system.right[k],
                 state.pressure[k],  {}};
    for (int d = 0; d < dim; ++d) head.position[d] = state.position(d, k);
    append(bytes, head);
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      append(bytes,
             RowEntry{static_cast<std::int32_t>(places[static_cast<std::size_t>(system.column[entry])]),
                      system.value[entry]});
    }
  }
  return bytes;
}

/// Joins the rows of all ranks to one system.
template <int dim>
void unpack_rows(const std::vector<Bytes>& all, std::int64_t rows, PressureSystem& system,
                 Eigen::VectorXd& guess, Vectors<dim>& position) {
  const auto each_row = [&](auto&& visit) {
    for (const Bytes& bytes : all)
      for (const std::byte* at = bytes.data(); at < bytes.data() + bytes.size();) {
        const auto head = take<RowHead>(at);
        visit(head, at);
        at += static_cast<std::size_t>(head.count) * sizeof(RowEntry);
      }
  };
  auto& own = system.own;
  own.start.assign(static_cast<std::size_t>(rows) + 1, 0);
  each_row([&](const RowHead& head, const std::byte*) {
    own.start[static_cast<std::size_t>(head.place) + 1] = head.count;
  });
  std::partial_sum(own.start.begin(), own.start.end(), own.start.begin());
  own.column.resize(static_cast<std::size_t>(own.start.back()));
  own.value.resize(own.column.size());
  for (Eigen::VectorXd* v : {&system.diagonal, &system.right, &guess}) v->resize(rows);
  position.resize(dim, rows);
  each_row([&](const RowHead& head, const std::byte* at) {
    system.diagonal[head.place] = head.diagonal;
    system.right[head.place] = head.right;
    guess[head.place] = head.guess;
    for (int d = 0; d < dim; ++d) position(d, head.place) = head.position[d];
    auto e = static_cast<std::size_t>(own.start[static_cast<std::size_t>(head.place)]);
    for (std::int64_t n = 0; n < head.count; ++n, ++e) {
      const auto entry = take<RowEntry>(at);
      own.column[e] = entry.column;
      own.value[e] = entry.value;
    }
  });
  own.stop.assign(own.start.begin() + 1, own.start.end());
  system.particle.resize(static_cast<std::size_t>(rows));
  std::iota(system.particle.begin(), system.particle.end(), 0);
  system.start = own.start;
  system.stop = own.stop;
  system.column = own.column;
  system.value = own.value;
}

}  // namespace

template <int dim>
void Simulation<dim>::Work::begin_on_ranks(const Ranks& ranks) {
  const auto refuse = [](const char* what) {
    throw Error(ExitCode::case_file, "fluid.ranks", std::string(what) + " is computed on one rank alone",
                "set fluid.ranks = 1");
  };
  if (step.p.scheme.gradient != Gradient::least_squares) refuse("a scheme other than least-squares");
  if (step.boundary.volume()) refuse("volume coupling");
  if (air) refuse("air under the body");
  const Tank<dim>& tank = step.boundary.tank();
  // Two particles that are so far outside their buckets are still found by the ranks that need them. Wider
  // buckets are divided anew less often, but are cells of the pressure's first grid: with 3.3 l0 the
  // iterations are those of one rank, with cells of 3.1 l0, plus one.
  const double width = step.search.radius() + 0.05 * step.p.spacing,
               slack = 0.45 * (1 - step.search.radius() / width);
  TankLayers<dim> layers{.count = tank.layers_of_whole(), .for_each = {}};
  if (!tank.moves()) layers.for_each = [&tank](const auto& visit) { tank.for_each_layer(visit); };
  step.subdomain = std::make_unique<Subdomain<dim>>(*ranks.communicator, ranks.partition,
                                                    Buckets<dim>(width, tank.periodic(), tank.shape().low()),
                                                    slack, layers);
  step.ranks = RankExchange<dim>(step.subdomain.get());
  if (ranks.shared_grid)
    shared_pressure =
        std::make_unique<RankedPressure<dim>>(*step.subdomain, ranks.shared_grid(), step.p.spacing);
  if (step.shared_water > 0) {
    step.state.initial_momentum = step.ranks.sum(step.state.initial_momentum);
    step.subdomain->take_start(step.state, step.shared_water);
    count_particles();
  } else {
    take_part();
  }
  divide(false);
}

template <int dim>
void Simulation<dim>::Work::take_part() {
  const std::int64_t before = step.subdomain->water_of_whole();
  step.subdomain->take_part(step.state, before > 0 ? before : step.boundary.water());
  count_particles();
}

template <int dim>
void Simulation<dim>::Work::count_particles() {
  step.boundary.set_water(step.subdomain->local_water());
  if (!step.boundary.select_tank_layers(step.subdomain->tank_layers(), step.state))
    return scheme->set_water(step);
  walls.forget();
  on_walls.resize(dim, 0);
  scheme->set_layers(step);
}

/// Sends particles to the ranks that own them now, and renews the ghosts.
template <int dim>
void Simulation<dim>::Work::divide(bool balance) {
  step.subdomain->divide(step.state, balance);
  count_particles();
  step.search.invalidate();
}

template <int dim>
void Simulation<dim>::Work::forget_ranks() {
  step.state.rank_boxes.resize(0);
  step.state.rank_buckets.clear();
}

template <int dim>
void Simulation<dim>::Work::begin_again() {
  step.boundary.adopt(step.state);
  step.search.invalidate();
  step.substepping.forget();
}

/// Removes what has left the tank, numbered in the order of the whole. Momentum is accounted for on all
/// ranks.
template <int dim>
void Simulation<dim>::Work::remove_lost_together() {
  struct Lost {
    std::int64_t place;
    double velocity[3];
  };
  State<dim>& state = step.state;
  const Boundary<dim>& boundary = step.boundary;
  const auto& places = step.subdomain->division().place;
  Bytes own;
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (!step.ranks.owns(i) || boundary.is_removed(state, i) || !boundary.left_domain(state.position.col(i)))
      continue;
    Lost lost{places[static_cast<std::size_t>(i)], {}};
    for (int d = 0; d < dim; ++d) lost.velocity[d] = state.velocity(d, i);
    append(own, lost);
  }
  std::vector<Lost> all;
  for (const Bytes& bytes : step.subdomain->communicator().gather(own))
    for (const std::byte* at = bytes.data(); at < bytes.data() + bytes.size();) all.push_back(take<Lost>(at));
  std::ranges::sort(all, {}, &Lost::place);
  for (const Lost& lost : all) {
    const std::int64_t number = state.lost++;
    const auto found = std::ranges::lower_bound(places, lost.place);
    if (found != places.end() && *found == lost.place)
      remove(found - places.begin(), number);
    else
      for (int d = 0; d < dim; ++d) state.impulse_on_walls[d] += step.mass * lost.velocity[d];
  }
}

template <int dim>
CollidingRanks Simulation<dim>::Work::colliding_ranks() {
  if (!step.subdomain) return {};
  return {step.subdomain->division().owned,
          [this](double distance) -> const Neighbours& { return pairs_of_ghosts(distance); }};
}

/// Returns the rows of the ghosts, with one another and with layers, at the present positions.
template <int dim>
const Neighbours& Simulation<dim>::Work::pairs_of_ghosts(double distance) {
  if (!ghost_search) ghost_search.emplace(distance, 0.0, step.search.periodic());
  const auto tags = step.boundary.tags(step.state, {}, step.ranks.absent_layers());
  std::vector<std::uint8_t> tag(tags.begin(), tags.end());
  for (std::int64_t i = 0; i < std::ssize(tag); ++i) {
    auto& of = tag[static_cast<std::size_t>(i)];
    if (i >= step.boundary.water())
      of |= passive;
    else if (step.ranks.owns(i))
      of = absent;
  }
  ghost_search->invalidate();
  return ghost_search->update(step.state.position, tag, [this](std::int32_t i, std::int32_t j) {
    return step.boundary.keep(step.state, i, j, false);
  });
}

/// Adds up the accounts of the collisions of all ranks, each of its own particles.
template <int dim>
void Simulation<dim>::Work::sum_collisions() {
  Communicator& communicator = step.subdomain->communicator();
  Vectors<dim> all(dim, collisions.on_points.cols() + 2);
  all << collisions.on_points, collisions.on_water, collisions.on_walls;
  Vectors<dim> total = Vectors<dim>::Zero(dim, all.cols()), part = total;
  const auto size = sizeof(double) * static_cast<std::size_t>(all.size());
  for (const Bytes& bytes :
       communicator.gather(std::as_bytes(std::span(all.data(), static_cast<std::size_t>(all.size()))))) {
    std::memcpy(part.data(), bytes.data(), std::min(size, bytes.size()));
    total += part;
  }
  collisions.on_points = total.leftCols(collisions.on_points.cols());
  collisions.on_water = total.col(total.cols() - 2);
  collisions.on_walls = total.col(total.cols() - 1);
  for (std::int64_t* count : {&collisions.inside, &collisions.behind_walls})
    *count = communicator.sum(*count);
}

template <int dim>
typename Simulation<dim>::Work::Solved Simulation<dim>::Work::solve_together() {
  if (!shared_pressure) return solve_on_first_rank();
  const bool sealed = shared_pressure->solve(system, step.state.position, step.state.pressure,
                                             may_be_sealed(), step.p.scheme, own_solution);
  return {own_solution, sealed};
}

template <int dim>
typename Simulation<dim>::Work::Solved Simulation<dim>::Work::solve_on_first_rank() {
  const Subdomain<dim>& own = *step.subdomain;
  Communicator& communicator = own.communicator();
  std::vector<Bytes> rows;
  communicator.show_first(packed_rows<dim>(system, own, step.state), [&](std::span<const std::byte> part) {
    rows.emplace_back(part.begin(), part.end());
  });
  Bytes answer;
  if (communicator.rank() == 0) {
    unpack_rows<dim>(rows, own.water_of_whole(), whole_system, guess, whole_position);
    const bool sealed = may_be_sealed() && close_sealed_blocks(whole_system) > 0;
    const PressureSolution& solution = poisson.solve(whole_system, whole_position, guess, step.p.scheme);
    append(answer, SolutionHead{solution.residual, solution.iterations, sealed ? 1 : 0});
    const auto bytes = std::as_bytes(
        std::span(solution.pressure.data(), static_cast<std::size_t>(solution.pressure.size())));
    answer.insert(answer.end(), bytes.begin(), bytes.end());
  }
  const Bytes told = communicator.gather(answer).front();
  const std::byte* at = told.data();
  const auto head = take<SolutionHead>(at);
  own_solution.residual = head.residual;
  own_solution.iterations = head.iterations;
  own_solution.pressure.resize(system.size());
  for (std::int64_t k = 0; k < system.size(); ++k)
    std::memcpy(
        &own_solution.pressure[k],
        at + sizeof(double) * static_cast<std::size_t>(own.division().place[static_cast<std::size_t>(k)]),
        sizeof(double));
  return {own_solution, head.sealed != 0};
}

template <int dim>
Extreme Simulation<dim>::Work::largest_of_ranks(const Extreme& own, std::int64_t place) const {
  struct Found {
    double value, at[3];
    std::int64_t place;
  };
  const std::int64_t whole_place =
      place < 0 ? -1 : step.subdomain->division().place[static_cast<std::size_t>(place)];
  Extreme largest = own;
  std::int64_t first = -1;
  double value = -1;
  for (const Found& found :
       step.subdomain->communicator().all(Found{own.value, {own.at[0], own.at[1], own.at[2]}, whole_place})) {
    if (found.place < 0 || !(found.value > value || (found.value == value && found.place < first))) continue;
    value = largest.value = found.value;
    largest.at = Eigen::Vector3d(found.at);
    first = found.place;
  }
  return largest;
}

#define STRAKE_INSTANTIATE(dim)                                                                 \
  template void Simulation<dim>::Work::begin_on_ranks(const Ranks&);                            \
  template Extreme Simulation<dim>::Work::largest_of_ranks(const Extreme&, std::int64_t) const; \
  template void Simulation<dim>::Work::take_part();                                             \
  template void Simulation<dim>::Work::count_particles();                                       \
  template void Simulation<dim>::Work::divide(bool);                                            \
  template void Simulation<dim>::Work::begin_again();                                           \
  template void Simulation<dim>::Work::forget_ranks();                                          \
  template void Simulation<dim>::Work::remove_lost_together();                                  \
  template void Simulation<dim>::Work::sum_collisions();                                        \
  template CollidingRanks Simulation<dim>::Work::colliding_ranks();                             \
  template typename Simulation<dim>::Work::Solved Simulation<dim>::Work::solve_together();      \
  template typename Simulation<dim>::Work::Solved Simulation<dim>::Work::solve_on_first_rank();
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
