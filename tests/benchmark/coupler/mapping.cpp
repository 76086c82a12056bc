#include "coupler/mapping/mapping.hpp"

#include "tests/benchmark/machine.hpp"
#include "tests/coupler/surfaces.hpp"

#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <malloc.h>
#include <optional>
#include <string>

// Mappings between two meshes of a wavy surface, the fluid's shifted by 0.3 spacings. Arguments: points of
// each mesh (the next square); threads. Time of an iteration: displacement with W. Counters: the shortest
// time of W and of Wᵀ (three components); the time to build, wall and processors; the memory that building
// adds, at most and in the end. The last one is the bytes of W over those that STREAM triad moves in the time
// of one product.

namespace {
using namespace strake;

/// A line of /proc/self/status [MB].
double status(const std::string& name) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name)) return 1e-3 * std::stod(line.substr(name.size() + 1));
  return std::nan("");
}

/// Of all threads of this process: what others do on the machine does not make it longer [s].
double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void mapping(benchmark::State& state, const std::string& kind, const RadialBasis& basis) {
  const auto threads = static_cast<int>(state.range(1));
  omp_set_num_threads(threads);
  const int m = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(state.range(0))))) - 1;
  const InterfaceMesh structure = wavy(m), fluid = wavy(m, 0.3);
  const Field u = {"displacement", "m", false, random_values(structure.position.cols(), 1)};
  const Field f = {"force", "N", true, random_values(fluid.position.cols(), 2)};

  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak starts again from here
  const double before = status("VmRSS:");
  std::optional<Mapping> built;
  const double processors = processor_seconds();
  const double build = benchmark_machine::shortest(
      1, [&] { built.emplace(make_mapping({.kind = kind, .radial_basis = basis}, structure, fluid)); });
  const double build_processors = processor_seconds() - processors;
  const double peak = status("VmHWM:") - before, stays = status("VmRSS:") - before;

  double there = 1e9, back = 1e9;
  for ([[maybe_unused]] auto step : state) {
    there = std::min(there,
                     benchmark_machine::shortest(1, [&] { benchmark::DoNotOptimize(built->consistent(u)); }));
    state.PauseTiming();
    back = std::min(
        back, benchmark_machine::shortest(1, [&] { benchmark::DoNotOptimize(built->conservative(f)); }));
    state.ResumeTiming();
  }
  state.counters["build s"] = build;
  state.counters["build cpu s"] = build_processors;
  state.counters["W ms"] = 1e3 * there;
  state.counters["W^T ms"] = 1e3 * back;
  state.counters["peak MB"] = peak;
  state.counters["stays MB"] = stays;
  state.counters["row"] = built->quality().row_size;
  state.counters["condition"] = built->quality().condition;
  const double bytes = 12.0 * static_cast<double>(built->weights().nonZeros());
  state.counters["of triad"] = bytes / there / benchmark_machine::triad_bandwidth(threads);
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int points : {1'000, 10'000, 100'000})
    for (const int threads : {1, 2}) b->Args({points, threads});
  b->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace

BENCHMARK_CAPTURE(mapping, nearest_neighbour, "nearest-neighbour", RadialBasis{})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, nearest_projection, "nearest-projection", RadialBasis{})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, linear_cell, "linear-cell", RadialBasis{})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, radial_c2, "radial-basis", RadialBasis{.function = "wendland-c2"})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, radial_c4, "radial-basis", RadialBasis{.function = "wendland-c4"})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, radial_c6, "radial-basis", RadialBasis{.function = "wendland-c6"})->Apply(sizes);
BENCHMARK_CAPTURE(mapping, thin_plate, "radial-basis", RadialBasis{.function = "thin-plate"})->Apply(sizes);
BENCHMARK_MAIN();
