#include "structure/particle/solver.hpp"
#include "tests/benchmark/machine.hpp"

#include <benchmark/benchmark.h>
#include <omp.h>

#include <map>
#include <memory>
#include <tuple>

// Sub-steps of elastic particles: leapfrog and the forces of all bonds. Arguments: 0 total Lagrangian, 1 pair
// model; dimension; layers through the plate; threads. Counters: nanoseconds per bond and step (each bond
// counts from both ends); bytes per particle of lattice, bonds, model and state; `streams`. `streams` is the
// time in units of one pass over those bytes at the bandwidth of STREAM triad, measured in the same run. 1 is
// the limit of a step that reads each byte once; `share of limit` is how near a step comes to it.

namespace {

using namespace strake::structure;
using strake::benchmark_machine::triad_bandwidth;

/// The paper's plate, free, in three dimensions 0.1 m deep.
Parameters plate(ParticleModel model, int dimension, int layers, int threads) {
  Parameters p;
  p.kind = "particle";
  p.dimension = dimension;
  p.plate.length = 0.4;
  p.plate.thickness = 0.02;
  if (dimension == 3) p.shape.depth = 0.1;
  p.particle.model = model;
  p.particle.spacing = p.plate.thickness / layers;
  p.surface_spacing = 0.02;
  p.threads = threads;
  return p;
}

template <class Array>
double bytes(const Array& a) {
  return static_cast<double>(static_cast<std::size_t>(a.size()) * sizeof(a(0)));
}

/// What one evaluation of the forces reads and writes at least once.
template <int dim>
double working_set(const Bonds<dim>& bonds) {
  const auto n = static_cast<double>(bonds.size());
  const double vectors = 8 * dim * n, tensors = 8 * dim * dim * n;
  return bytes(bonds.weight) + bytes(bonds.r0) + 8.0 * static_cast<double>(bonds.neighbour.size()) +
         bytes(bonds.shape_inverse) + tensors + 4 * vectors;
}

double bandwidth(int threads) {
  static std::map<int, double> known;
  const auto found = known.find(threads);
  return found != known.end() ? found->second
                              : known.emplace(threads, triad_bandwidth(threads)).first->second;
}

template <int dim>
void run(benchmark::State& state) {
  const auto model = state.range(0) == 0 ? ParticleModel::total_lagrangian : ParticleModel::pair;
  const int layers = static_cast<int>(state.range(2)), threads = static_cast<int>(state.range(3));
  omp_set_num_threads(threads);
  ParticleSolver<dim> solver(plate(model, dim, layers, threads));
  const Bonds<dim> bonds = make_bonds<dim>(solver.lattice(), 2.1);
  const double dt = 10 * solver.stable_dt();
  double t = 0, best = std::numeric_limits<double>::infinity();
  for ([[maybe_unused]] auto step : state) {
    const double seconds = strake::benchmark_machine::shortest(1, [&] { solver.advance(t, dt, {}); });
    t += dt;
    best = std::min(best, seconds / 10);
  }
  const auto n = static_cast<double>(bonds.size()), m = static_cast<double>(bonds.weight.size());
  state.counters["particles"] = n;
  state.counters["bonds per particle"] = m / n;
  state.counters["ns per bond"] = 1e9 * best / m;
  state.counters["bytes per particle"] = working_set<dim>(bonds) / n;
  state.counters["triad GB/s"] = 1e-9 * bandwidth(threads);
  state.counters["streams"] = best * bandwidth(threads) / working_set<dim>(bonds);
  state.counters["share of limit"] = working_set<dim>(bonds) / (best * bandwidth(threads));
}

void particle_step(benchmark::State& state) {
  if (state.range(1) == 3)
    run<3>(state);
  else
    run<2>(state);
}

BENCHMARK(particle_step)
    ->ArgNames({"pair", "dim", "layers", "threads"})
    ->Args({0, 2, 8, 1})
    ->Args({0, 2, 64, 1})
    ->Args({0, 2, 64, 2})
    ->Args({1, 2, 8, 1})
    ->Args({1, 2, 64, 1})
    ->Args({0, 3, 8, 1})
    ->Args({0, 3, 8, 2})
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(0.5);

}  // namespace

BENCHMARK_MAIN();
