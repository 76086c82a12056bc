// Water on processes, for fluid_ranks.py: mpirun -n N fluid_mpi_ranks FOLDER. The first rank writes
// FOLDER/N.json, and the whole state after one step as bytes, sorted by particle. With "counts" behind it,
// for scale_model.py: counts of a step of a larger box, far from the steps in which the water is sorted.
// With "column", "entry" or "still", a dimension and a number of particles behind it, for rank_iterations.py
// and rank_instructions.py: the iterations of each of the first steps.

#include "fluid/ranks/boomer_amg.hpp"
#include "fluid/ranks/zoltan_partition.hpp"
#include "proto/ranks/mpi_communicator.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/ranks/flow.hpp"
#include "tests/fluid/solid_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string>

namespace strake::fluid {
namespace {

/// Writes pressures and velocities in the order of the particles' numbers.
template <int dim>
void write(const State<dim>& state, const std::string& path) {
  std::vector<std::size_t> order(state.id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return state.id[i]; });
  std::ofstream file(path, std::ios::binary);
  for (const std::size_t i : order) {
    if (state.kind[i] != Kind::fluid) continue;
    const auto k = static_cast<Eigen::Index>(i);
    file.write(reinterpret_cast<const char*>(&state.pressure[k]), sizeof(double));
    file.write(reinterpret_cast<const char*>(state.velocity.col(k).data()), dim * sizeof(double));
  }
}

template <int dim>
std::string compute(Flow<dim> flow, MpiCommunicator& ranks, const std::string& folder,
                    const std::string& name) {
  const double depth = (flow.p.water.max - flow.p.water.min).y(),
               scale = flow.p.density * (flow.p.gravity.norm() * depth + flow.speed * flow.speed);
  Simulation<dim> simulation(flow.p, flow.body, flow.velocity(),
                             Ranks{&ranks, zoltan_partition, [&] { return boomer_amg(ranks); }});
  const int last = flow.steps;
  flow.steps = 1;
  int iterations = flow.run(simulation).pressure_iterations;
  const State<dim>& whole = simulation.whole();
  if (ranks.rank() == 0) write(whole, fmt::format("{}/{}.{}", folder, ranks.size(), name));
  std::int64_t ghosts = 0, own = whole.position.cols();
  std::vector<std::int64_t> all = {own};
  const std::int64_t before = ranks.account().bytes;
  flow.steps = last;
  iterations = std::max(iterations, flow.run(simulation).pressure_iterations);
  if (const Subdomain<dim>* part = simulation.ranks().subdomain()) {
    own = std::ranges::count(part->division().owner, ranks.rank());
    ghosts = ranks.sum(part->local_water() - own);
    all = ranks.all(own);
  }
  const auto mean =
      static_cast<double>(std::reduce(all.begin(), all.end())) / static_cast<double>(all.size());
  const auto sent = static_cast<double>(ranks.sum(ranks.account().bytes - before));
  return fmt::format(
      "\n \"{}\": {{\"iterations\": {}, \"scale\": {:.17g}, \"ghosts\": {:.4f}, \"imbalance\": {:.4f}, "
      "\"bytes\": {:.1f}}}",
      name, iterations, scale, static_cast<double>(ghosts) / (mean * static_cast<double>(all.size())),
      static_cast<double>(std::ranges::max(all)) / mean,
      ghosts > 0 ? sent / static_cast<double>(ghosts) / flow.steps : 0.0);
}

std::string counts(MpiCommunicator& ranks) {
  Flow<3> box{.p = basin(1.6, 0.8, 0.02, 0.1), .body = {}, .dt = 5e-4, .steps = 2};
  Simulation<3> simulation(box.p, box.body, box.velocity(),
                           Ranks{&ranks, zoltan_partition, [&] { return boomer_amg(ranks); }});
  box.run(simulation);
  const Communicator::Account before = ranks.account();
  const int iterations = box.run(simulation).pressure_iterations;
  const Communicator::Account after = ranks.account();
  const Subdomain<3>& part = *simulation.ranks().subdomain();
  const auto own = std::ranges::count(part.division().owner, ranks.rank());
  const auto size = static_cast<double>(ranks.size());
  std::int64_t first_ring = 0;
  for (const auto& list : part.division().near.receive) first_ring += std::ssize(list);
  first_ring = ranks.sum(first_ring);
  const std::int64_t ghosts = ranks.sum(part.local_water() - own), all = ranks.sum(std::int64_t{own});
  const double most = ranks.max(static_cast<double>(own)), mean = static_cast<double>(all) / size;
  const auto messages = ranks.max(static_cast<double>(after.messages - before.messages));
  const std::int64_t bytes = ranks.sum(after.bytes - before.bytes);
  return fmt::format(
      "\n \"counts\": {{\"own\": {:.1f}, \"ghosts\": {:.4f}, \"first_ring\": {:.4f}, "
      "\"imbalance\": {:.4f}, \"iterations\": {}, "
      "\"bytes\": {:.1f}, \"messages\": {:.1f}, \"sums\": {:.1f}}}",
      mean, static_cast<double>(ghosts) / static_cast<double>(all),
      static_cast<double>(first_ring) / static_cast<double>(all), most / mean, iterations,
      static_cast<double>(bytes) / static_cast<double>(ghosts) / box.steps, messages / box.steps,
      static_cast<double>(after.together - before.together) / box.steps);
}

/// Water as high as wide that collapses: n spacings, in a tank twice as wide.
template <int dim>
Flow<dim> column_of(double particles) {
  const double l0 = 0.01, height = l0 * std::round(std::pow(particles, 1.0 / dim));
  Flow<dim> flow{.p = tank_case(2 * height, height, l0, 0.2 * height), .body = {}};
  flow.p.dimension = dim;
  flow.p.tank.max[1] = l0 * std::round(0.2 * height / l0);
  flow.p.water.max[0] = 0;
  if (dim == 3) flow.p.tank.max[2] = flow.p.water.max[2] = height;
  flow.dt = 0.1 * l0 / std::sqrt(9.81 * height);
  return flow;
}

/// Water twice as wide as deep, and a box of a quarter of its width that enters it, a fifth of l0 above.
template <int dim>
Flow<dim> entry_of(double particles) {
  const double l0 = 0.01, width = 2 * l0 * std::round(0.5 * std::pow(2 * particles, 1.0 / dim)),
               above = l0 * std::round(0.25 * width / l0), low = 0.2 * l0, body = 0.25 * width;
  Flow<dim> flow{
      .p = dim == 3 ? basin(width, 0.5 * width, l0, above) : tank_case(width, 0.5 * width, l0, above),
      .body = dim == 3 ? box_surface({0, low, 0}, {body, 0.25 * body, body}, l0)
                       : rectangle(-0.5 * body, low, body, 0.25 * body, l0),
      .speed = 3};
  flow.dt = 0.05 * l0 / flow.speed;
  return flow;
}

/// Still water twice as wide as deep, in space as deep as it is long.
template <int dim>
Flow<dim> still_of(double particles) {
  const double l0 = 0.01, depth = 5 * l0 * std::round(0.2 * std::pow(0.5 * particles, 1.0 / dim));
  Flow<dim> flow{.p = tank_case(2 * depth, depth, l0, 0.2 * depth), .body = {}, .dt = 1.5e-3};
  flow.p.dimension = dim;
  if (dim == 3) flow.p.tank.max[2] = flow.p.water.max[2] = depth;
  return flow;
}

template <int dim>
std::string iterations(const std::string& name, double particles, MpiCommunicator& ranks) {
  const Flow<dim> flow = name == "still"    ? still_of<dim>(particles)
                         : name == "column" ? column_of<dim>(particles)
                                            : entry_of<dim>(particles);
  Simulation<dim> simulation(flow.p, flow.body, flow.velocity(),
                             Ranks{&ranks, zoltan_partition, [&] { return boomer_amg(ranks); }});
  std::vector<int> counts;
  for (int k = 0; k < 5; ++k) counts.push_back(flow.step(simulation, k).pressure_iterations);
  const auto water = std::ranges::count(simulation.whole().kind, Kind::fluid);
  return fmt::format("\"particles\": {}, \"iterations\": [{}]", water, fmt::join(counts, ", "));
}

void compute_all(MpiCommunicator& ranks, const std::string& folder) {
  Flow<2> column{.p = tank_case(1.2, 0.4, 0.01, 0.2), .body = {}, .dt = 5e-4, .steps = 8};
  column.p.water.max[0] = 0.1;
  Flow<3> box{.p = basin(0.8, 0.4, 0.02, 0.1),
              .body = box_surface({0, 0.004, 0}, {0.16, 0.04, 0.16}, 0.02),
              .speed = 3,
              .dt = 5e-5,
              .steps = 4};
  std::string text = compute(column, ranks, folder, "column");
  text += "," + compute(box, ranks, folder, "box");
  if (ranks.rank() == 0)
    std::ofstream(fmt::format("{}/{}.json", folder, ranks.size())) << "{" << text << "}\n";
}

}  // namespace
}  // namespace strake::fluid

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    strake::MpiCommunicator ranks(MPI_COMM_WORLD);
    if (argc > 4) {
      const double particles = std::stod(argv[4]);
      const std::string text = std::string(argv[3]) == "3"
                                   ? strake::fluid::iterations<3>(argv[2], particles, ranks)
                                   : strake::fluid::iterations<2>(argv[2], particles, ranks);
      if (ranks.rank() == 0)
        std::ofstream(fmt::format("{}/{}.json", argv[1], ranks.size())) << "{" << text << "}\n";
    } else if (argc > 2) {
      const std::string text = strake::fluid::counts(ranks);
      if (ranks.rank() == 0)
        std::ofstream(fmt::format("{}/{}.json", argv[1], ranks.size())) << "{" << text << "}\n";
    } else {
      strake::fluid::compute_all(ranks, argv[1]);
    }
  }
  MPI_Finalize();
  return 0;
}
