#include "tests/benchmark/machine.hpp"
#include "tests/fluid/plate_case.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <unistd.h>

// Whole MPS steps, with everything a step of a run does but its output.
// plate_entry_step: the rigid plate entry just after contact (10 000 water particles), in windows of 1e-5 s
// as a run
//   of it takes, where the steps are shorter; the time is the mean of a window's steps, of which the first
//   finds pairs, surface and stresses for all. Arguments: 1500 or 0 (0: incompressible) [m/s]; time step
//   [µs/10]; threads.
// column_step: a column 2 wide and 1 high (and 1 deep) after its first steps of collapse, incompressible.
//   Arguments: dimension; water particles in thousands; threads. Counters: microseconds per particle (all
//   that are stored) and bytes per particle at the peak.
// Beside each: the time as so many plain products of a sparse matrix with as many rows, and as the bytes per
// particle that STREAM triad would have moved in it.

namespace {

using namespace strake::fluid;
using strake::benchmark_machine::Machine;
using strake::benchmark_machine::Ratios;

constexpr double window = 1e-5;  // [s] of cases/plate_entry.toml

/// The machine is measured once for a size.
const Machine& machine_of(int dimension, std::int64_t particles, int threads) {
  static std::map<std::tuple<int, std::int64_t, int>, Machine> known;
  const auto key = std::tuple(dimension, particles, threads);
  const auto found = known.find(key);
  return found != known.end() ? found->second
                              : known.emplace(key, Machine(dimension, particles, threads)).first->second;
}

/// The time of an iteration and of its stages, from the simulation's own clocks.
class Stages {
 public:
  Stages(benchmark::State& state, const std::map<std::string, double>& seconds)
      : state_(state), seconds_(seconds), before_(seconds) {}
  void report(int dimension, std::int64_t particles, int threads) {
    double sum = 0;
    const auto n = static_cast<double>(state_.iterations());
    for (const auto& [stage, seconds] : seconds_) {
      const double part = (seconds - (before_.contains(stage) ? before_.at(stage) : 0)) / n;
      state_.counters[stage + " ms"] = 1e3 * part;
      sum += part;
    }
    const Ratios ratios = machine_of(dimension, particles, threads).beside(sum);
    state_.counters["particles"] = static_cast<double>(particles);
    state_.counters["us per particle"] = 1e6 * sum / static_cast<double>(particles);
    state_.counters["products"] = ratios.spmvs;
    state_.counters["triad bytes"] = ratios.triad_bytes;
    state_.counters["triad GB/s"] = ratios.triad_gb_per_s;
  }

 private:
  benchmark::State& state_;
  const std::map<std::string, double>& seconds_;
  std::map<std::string, double> before_;
};

void plate_entry_step(benchmark::State& state) {
  Parameters p = PlateEntry::parameters();
  p.sound_speed =
      state.range(0) > 0 ? static_cast<double>(state.range(0)) : std::numeric_limits<double>::infinity();
  p.threads = static_cast<int>(state.range(2));
  const double dt = 1e-7 * static_cast<double>(state.range(1));
  p.scheme.time_step = dt;
  PlateEntry plate(p, 6.26, 0.001);
  const auto in_window = std::max<std::int64_t>(1, std::llround(window / dt));
  std::int64_t taken = 0;
  const auto step = [&] {
    const std::int64_t to_come = in_window - 1 - taken++ % in_window;
    return plate.step(dt, static_cast<double>(to_come) * dt).pressure_iterations;
  };
  while (plate.time < 0.2e-3 || taken % in_window != 0) step();  // past contact
  Stages stages(state, plate.simulation.seconds());
  double iterations = 0;
  for ([[maybe_unused]] auto once : state) iterations += step();
  stages.report(2, plate.simulation.state().position.cols(), p.threads);
  state.counters["solver iterations"] = iterations / static_cast<double>(state.iterations());
}

/// Of /proc/self/status [bytes]: VmRSS now, VmHWM since the last `forget_peak`.
double memory(const std::string& what) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(what + ":")) return 1024 * std::stod(line.substr(what.size() + 1));
  return std::numeric_limits<double>::quiet_NaN();
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

template <int dim>
void column(benchmark::State& state) {
  const double water = 1e3 * static_cast<double>(state.range(1));
  const auto high = static_cast<int>(std::lround(std::pow(water / 2, 1.0 / dim)));
  const double l0 = 1.0 / high;
  Parameters p;
  p.dimension = dim;
  p.spacing = l0;
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.threads = static_cast<int>(state.range(2));
  p.tank.min.setZero();
  p.water.min.setZero();
  p.water.max = {2 * high * l0, high * l0, dim == 3 ? high * l0 : 0};
  p.tank.max = {5 * high * l0, 2 * high * l0, dim == 3 ? high * l0 : 0};
  forget_peak();
  const double before = memory("VmRSS");
  {
    Simulation<dim> simulation(p, {}, {});
    const InterfaceMotion none{strake::Points(3, 0), strake::Points(3, 0), strake::Points(3, 0)};
    const auto step = [&] { return simulation.step(simulation.stable_dt(), none).pressure_iterations; };
    for (int k = 0; k < 3; ++k) step();
    Stages stages(state, simulation.seconds());
    double iterations = 0;
    for ([[maybe_unused]] auto once : state) iterations += step();
    const auto particles = simulation.state().position.cols();
    const double peak = memory("VmHWM");
    stages.report(dim, particles, p.threads);
    state.counters["solver iterations"] = iterations / static_cast<double>(state.iterations());
    state.counters["bytes per particle"] = (peak - before) / static_cast<double>(particles);
  }
}

void column_step(benchmark::State& state) {
  if (state.range(0) == 2)
    column<2>(state);
  else
    column<3>(state);
}

}  // namespace

BENCHMARK(plate_entry_step)
    ->Args({1500, 20, 1})
    ->Args({1500, 20, 2})
    ->Args({0, 100, 1})
    ->Args({0, 100, 2})
    ->Args({1500, 100, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(column_step)
    ->ArgsProduct({{2}, {10, 100, 1000}, {1, 2}})
    ->ArgsProduct({{3}, {100, 500, 2000}, {2}})
    ->Iterations(3)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_MAIN();
