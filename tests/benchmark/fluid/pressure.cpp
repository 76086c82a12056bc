#include "tests/benchmark/fluid/library_solvers.hpp"
#include "tests/benchmark/machine.hpp"
#include "tests/fluid/pressure_cases.hpp"

#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <tuple>

// Solves the pressure equation of the hardest tank: P = 0 on the top layer alone, noise as right side.
// Particles are uniform, moved by up to a tenth of the spacing. Times are of set-up and of the solve to ‖b −
// A p‖ = tolerance ‖b‖ from p = 0. Arguments: unknowns in thousands; reach in tenths of the spacing; threads;
// exponent of the tolerance. Counters: iterations; memory of the solver per unknown; the time in units of one
// product of the same matrix in plain compressed rows; the bytes per unknown that STREAM triad moves in that
// time.

namespace {

using namespace strake::fluid;
using namespace strake::benchmark_machine;

struct Tank {
  PressureCase<2> particles;
  PressureSystem system;
  CompressedRows plain;  // the same matrix
  Tank(int side, double radius) : particles(tank<2>(side, radius)), system(particles.assemble()) {
    plain.begin.assign(1, 0);
    for (std::size_t k = 0; k < system.particle.size(); ++k) {
      plain.column.push_back(static_cast<std::int32_t>(k));
      plain.value.push_back(system.diagonal[static_cast<Eigen::Index>(k)]);
      for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
        plain.column.push_back(system.column[static_cast<std::size_t>(e)]);
        plain.value.push_back(system.value[static_cast<std::size_t>(e)]);
      }
      plain.begin.push_back(static_cast<std::int64_t>(plain.column.size()));
    }
  }
};

const Tank& tank_of(std::int64_t thousands, std::int64_t tenths) {
  static std::pair<std::int64_t, std::int64_t> held;
  static std::unique_ptr<Tank> one;  // the large ones do not fit side by side
  if (!one || held != std::pair(thousands, tenths)) {
    one.reset();
    one =
        std::make_unique<Tank>(static_cast<int>(std::lround(std::sqrt(1e3 * static_cast<double>(thousands)))),
                               0.1 * static_cast<double>(tenths));
    held = {thousands, tenths};
  }
  return *one;
}

/// One solve from p = 0; gives its iterations.
using Solve = std::function<int(const Tank&, const Eigen::VectorXd& zero, double tolerance)>;

/// `bytes`: memory of the solver after the solves, where it tells.
void measure(benchmark::State& state, const Solve& solve, const std::function<std::size_t()>& bytes) {
  const Tank& tank = tank_of(state.range(0), state.range(1));
  const auto threads = static_cast<int>(state.range(2));
  const auto n = static_cast<double>(tank.system.size());
  const double tolerance = std::pow(10.0, -static_cast<double>(state.range(3)));
  omp_set_num_threads(threads);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tank.system.size());
  double best = std::numeric_limits<double>::infinity();
  int iterations = 0;
  for (auto _ : state) {
    const double seconds = shortest(1, [&] { iterations = solve(tank, zero, tolerance); });
    best = std::min(best, seconds);
    state.SetIterationTime(seconds);
  }
  const double spmv = spmv_seconds(tank.plain, threads), triad = triad_bandwidth(threads);
  state.counters["best ms"] = 1e3 * best;
  state.counters["iterations"] = iterations;
  state.counters["bytes/unknown"] = static_cast<double>(bytes()) / n;
  state.counters["spmv ms"] = 1e3 * spmv;
  state.counters["in spmvs"] = best / spmv;
  state.counters["triad GB/s"] = 1e-9 * triad;
  state.counters["in triad bytes/unknown"] = best * triad / n;
}

void ours(benchmark::State& state, Preconditioner preconditioner) {
  const Tank& tank = tank_of(state.range(0), state.range(1));
  Scheme scheme;
  scheme.preconditioner = preconditioner;
  scheme.radius_laplacian = tank.particles.radius;
  PoissonSolver<2> poisson(tank.particles.radius);
  measure(
      state,
      [&](const Tank& one, const Eigen::VectorXd& zero, double tolerance) {
        scheme.pressure_tolerance = tolerance;
        return poisson.solve(one.system, one.particles.position, zero, scheme).iterations;
      },
      [&] { return poisson.bytes(); });
}

using LibrarySolver = void (*)(const PressureSystem&, double tolerance, int max_iterations,
                               PressureSolution&);

void library(benchmark::State& state, LibrarySolver solver) {
  if (solver == &solve_hypre && !has_hypre()) {
    state.SkipWithError("hypre was not there when this was built");
    return;
  }
  measure(
      state,
      [&](const Tank& one, const Eigen::VectorXd& zero, double tolerance) {
        PressureSolution solution;
        solution.pressure = zero;
        solver(one.system, tolerance, 5000, solution);
        return solution.iterations;
      },
      [] { return std::size_t{0}; });
}

void cholmod(const PressureSystem& system, double, int, PressureSolution& solution) {
  solve_cholmod(system, solution);
}

void sizes(benchmark::internal::Benchmark* b, std::int64_t largest) {
  for (const std::int64_t thousands : {10, 100, 1000})
    for (const std::int64_t tenths : {21, 31})
      for (const std::int64_t threads : {1, 2})
        if (thousands <= largest) b->Args({thousands, tenths, threads, 8});
  if (largest >= 1000) b->Args({1000, 31, 2, 6});
  b->UseManualTime()->Unit(benchmark::kMillisecond)->MinTime(0.5);
}

}  // namespace

BENCHMARK_CAPTURE(ours, multilevel, Preconditioner::multilevel)->Apply([](auto* b) { sizes(b, 1000); });
BENCHMARK_CAPTURE(ours, jacobi, Preconditioner::jacobi)->Apply([](auto* b) { sizes(b, 100); });
BENCHMARK_CAPTURE(library, ic, &solve_incomplete_cholesky)->Apply([](auto* b) { sizes(b, 100); });
BENCHMARK_CAPTURE(library, hypre, &solve_hypre)->Apply([](auto* b) { sizes(b, 100); });
BENCHMARK_CAPTURE(library, cholmod, &cholmod)->Apply([](auto* b) { sizes(b, 100); });
BENCHMARK_MAIN();
