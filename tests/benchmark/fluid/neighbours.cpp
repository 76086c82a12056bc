#include "fluid/particles/neighbours.hpp"

#include "fluid/particles/reorder.hpp"
#include "tests/benchmark/machine.hpp"
#include "tests/fluid/lattice.hpp"

#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

// The neighbour search on a block of water with some disorder, skin 0.2 l0. Arguments: particles along an
// edge; threads; radius in l0/10 (beside 3.1 also the rows of 2.1); order of the particles (0 as filled, 1
// scrambled, 2 scrambled, then sorted along the cells). rebuild: cells, candidates and rows; update: rows of
// particles that moved within the skin. Each figure is the shortest of the repeats of one run; beside it the
// bytes that STREAM triad moves in the same time, per particle.

namespace {
using namespace strake::fluid;

constexpr double l0 = 0.01;

template <int dim>
Vectors<dim> water(int side, int order) {
  Vectors<dim> x = block<dim>(side, l0, 0.1);
  if (order == 0) return x;
  std::vector<std::int32_t> place(static_cast<std::size_t>(x.cols()));
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), std::mt19937(5));
  Vectors<dim> mixed = x(Eigen::all, place);
  if (order == 1) return mixed;
  return mixed(Eigen::all, cell_order<dim>(mixed, 3.3 * l0));
}

template <int dim>
void neighbours(benchmark::State& state, bool rebuild) {
  const auto threads = static_cast<int>(state.range(1));
  omp_set_num_threads(threads);
  Vectors<dim> x = water<dim>(static_cast<int>(state.range(0)), static_cast<int>(state.range(3)));
  const double radius = 0.1 * static_cast<double>(state.range(2)) * l0;
  NeighbourSearch<dim> search(radius, 0.2 * l0);
  search.update(x);
  double shortest = 1e9, way = 0.02 * l0;
  for ([[maybe_unused]] auto step : state) {
    state.PauseTiming();
    x.row(0).array() += way;  // the same rows from other places
    way = -way;
    if (rebuild) search.invalidate();
    state.ResumeTiming();
    shortest = std::min(shortest, strake::benchmark_machine::shortest(1, [&] {
                          search.update(x);
                          search.within(std::min(radius, 2.1 * l0));
                        }));
  }
  const auto n = static_cast<double>(x.cols());
  state.counters["best ms"] = 1e3 * shortest;
  state.counters["ns per particle"] = 1e9 * shortest / n;
  state.counters["bytes per particle"] = static_cast<double>(search.bytes()) / n;
  state.counters["pairs per particle"] = static_cast<double>(search.within(radius).column().size()) / n;
  state.counters["triad bytes"] = strake::benchmark_machine::triad_bandwidth(threads) * shortest / n;
}

void sizes_2d(benchmark::internal::Benchmark* b) {
  for (const int side : {107, 316, 1000})
    for (const int threads : {1, 2})
      for (const int order : {0, 1, 2})
        if (order == 0 || threads == 1) b->Args({side, threads, 31, order});
  b->Unit(benchmark::kMillisecond)->UseRealTime();
}
void sizes_3d(benchmark::internal::Benchmark* b) {
  for (const int side : {47, 126})
    for (const int threads : {1, 2}) b->Args({side, threads, 21, 0});
  b->Args({47, 1, 21, 1})->Args({47, 1, 21, 2})->Args({47, 1, 31, 0});
  b->Unit(benchmark::kMillisecond)->UseRealTime();
}

void neighbours_2d(benchmark::State& state, bool rebuild) {
  neighbours<2>(state, rebuild);
}
void neighbours_3d(benchmark::State& state, bool rebuild) {
  neighbours<3>(state, rebuild);
}

}  // namespace

BENCHMARK_CAPTURE(neighbours_2d, rebuild, true)->Apply(sizes_2d);
BENCHMARK_CAPTURE(neighbours_2d, update, false)->Apply(sizes_2d);
BENCHMARK_CAPTURE(neighbours_3d, rebuild, true)->Apply(sizes_3d);
BENCHMARK_CAPTURE(neighbours_3d, update, false)->Apply(sizes_3d);
BENCHMARK_MAIN();
