#include <benchmark/benchmark.h>

#include <limits>

#include "tests/fluid/plate_case.hpp"

// One whole MPS step of the rigid plate entry (10 000 water particles), just after contact, on one thread.
// Arguments: 1500 or 0 (0: incompressible) [m/s]; time step [µs/10].

namespace {

void plate_entry_step(benchmark::State& state) {
  using namespace strake::fluid;
  Parameters p = PlateEntry::parameters();
  p.sound_speed =
      state.range(0) > 0 ? static_cast<double>(state.range(0)) : std::numeric_limits<double>::infinity();
  const double dt = 1e-7 * static_cast<double>(state.range(1));
  p.scheme.time_step = dt;
  PlateEntry plate(p, 6.26, 0.001);
  while (plate.time < 0.2e-3) plate.step(dt);  // past contact
  const auto before = plate.simulation.seconds();
  double iterations = 0;
  for ([[maybe_unused]] auto step : state) iterations += plate.step(dt).pressure_iterations;
  const auto n = static_cast<double>(state.iterations());
  for (const auto& [stage, seconds] : plate.simulation.seconds())
    state.counters[stage + " ms"] = 1e3 * (seconds - before.at(stage)) / n;
  state.counters["solver iterations"] = iterations / n;
}

}  // namespace

BENCHMARK(plate_entry_step)
    ->Args({1500, 20})
    ->Args({1500, 100})
    ->Args({0, 100})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
