#include "structure/fem/solver.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <malloc.h>
#include <memory>
#include <numbers>
#include <string>
#include <sys/resource.h>

// Time and memory of finite elements: set-up, and one step. Also compares the clamped square plate of
// cases/VALIDATION.md, "Finite elements: locking, and plates in space", with its references. Arguments:
// dimension; refinement; 1 factors, 2 conjugate gradients with multigrid, 0 what `auto` chooses. Counters:
// unknowns; seconds to build the solver (mesh, matrices, first frequency); milliseconds of a step with all
// its Newton corrections, with existing factors; MiB of the solver's heap; peak MiB of the process (one case
// at a time: --benchmark_filter).

namespace {

using namespace strake::structure;
using namespace strake::structure::fem;

double heap() {  // [MiB] in use
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / (1024.0 * 1024.0);
}

double peak() {  // [MiB] resident
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

LinearMethod method(const benchmark::State& state, int argument) {
  const auto asked = state.range(argument);
  return asked == 0 ? LinearMethod::automatic : asked == 1 ? LinearMethod::direct : LinearMethod::cg_amg;
}

/// The paper's plate between clamps; in three dimensions a slab as deep as a fifth of its length.
Parameters plate(int dimension, int refinement, LinearMethod method) {
  Parameters p;
  p.dimension = dimension;
  p.shape.kind = ShapeKind::solid;
  SolidBox box;
  box.name = "plate";
  box.max << 0.4, 0.02, dimension == 3 ? 0.08 : 0.0;
  box.support[0] = box.support[1] = Support::clamped;
  p.solid = solid_of_boxes(dimension, {box});
  if (dimension == 2) p.shape.corner = outer_polygons(p.solid).front();
  p.load = {.kind = LoadKind::traction, .value = {0, -1e6, 0}, .face = "top", .at = {}, .ramp = 1e-3};
  p.fem.refinement = refinement;
  p.fem.linear_solver = method;
  return p;
}

template <int dim>
void run(benchmark::State& state) {
  const double before = heap();
  std::unique_ptr<FemSolver<dim>> solver;
  const Parameters p = plate(dim, static_cast<int>(state.range(1)), method(state, 2));
  state.counters["s to build"] = seconds_of([&] { solver = std::make_unique<FemSolver<dim>>(p); });
  const double dt = 1e-5;
  double t = 0;
  state.counters["s of the first step"] = seconds_of([&] { solver->advance(t, dt, {}); });
  double best = std::numeric_limits<double>::infinity();
  for ([[maybe_unused]] auto step : state) {
    t += dt;
    best = std::min(best, seconds_of([&] { solver->advance(t, dt, {}); }));
  }
  state.counters["unknowns"] = solver->mesh().n_unknowns();
  state.counters["ms of a step"] = 1e3 * best;
  state.counters["MiB"] = heap() - before;
}

void fem_step(benchmark::State& state) {
  if (state.range(0) == 3)
    run<3>(state);
  else
    run<2>(state);
}

BENCHMARK(fem_step)
    ->ArgNames({"dim", "refinement", "method"})
    ->Args({2, 1, 1})
    ->Args({2, 3, 1})
    ->Args({2, 3, 2})
    ->Args({3, 0, 1})
    ->Args({3, 0, 2})
    ->Args({3, 1, 1})
    ->Args({3, 1, 2})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

/// 1 m × 1 m × 0.01 m of steel, clamped all around, under 1 kPa. Thin plates: w = 0.00126532 q a⁴/D
/// (Timoshenko & Woinowsky-Krieger 1959), ω a² √(ρh/D) = 35.985 (Leissa 1969 has 35.992). Q2, one thread of
/// a shared machine:
///   refinement  unknowns  deflection   f1       build, static, first frequency   peak
///   0            29 241   −0.31 %      +0.16 %   1.2 s   0.4 s   0.8 s          0.5 GiB
///   2           128 547   −0.07 %      +0.04 %  13.2 s   6.3 s   7.4 s          2.4 GiB (0.6 of it factors)
/// Conjugate gradients with multigrid need 328 iterations for one solve to 1e-6 at refinement 0 (11 s); at
/// refinement 2, whose cells are flat, the residual is above 1e-4 after 2000.
void clamped_square_plate(benchmark::State& state) {
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  const double thickness = 0.01;
  SolidBox box;
  box.name = "plate";
  box.max << 1, thickness, 1;
  for (const std::size_t side : {0U, 1U, 4U, 5U}) box.support.at(side) = Support::clamped;
  box.material.model = MaterialModel::linear;
  p.solid = solid_of_boxes(3, {box});
  p.surface_spacing = 0.1;
  p.load = {.kind = LoadKind::traction, .value = {0, -1e3, 0}, .face = "top", .at = {}, .ramp = 0};
  p.fem.refinement = static_cast<int>(state.range(0));
  p.fem.linear_solver = method(state, 1);
  const Material& m = box.material;
  const double D = m.bending_modulus() * std::pow(thickness, 3) / 12;
  const double w = 0.00126532 * 1e3 / D,
               f1 = 35.985 / (2 * std::numbers::pi) * std::sqrt(D / (m.density * thickness));
  for ([[maybe_unused]] auto once : state) {
    const double before = heap();
    std::unique_ptr<FemSolver<3>> solver;
    state.counters["s to build"] = seconds_of([&] { solver = std::make_unique<FemSolver<3>>(p); });
    state.counters["s static"] = seconds_of([&] { solver->solve_static(); });
    state.counters["deflection over reference"] = -solver->displacement_at({0.5, thickness / 2, 0.5}).y() / w;
    state.counters["MiB"] = heap() - before;
    double frequency = 0;
    state.counters["s modal"] = seconds_of([&] { frequency = solver->frequencies(1).front(); });
    state.counters["f1 over reference"] = frequency / f1;
    state.counters["peak MiB"] = peak();
    state.counters["unknowns"] = solver->mesh().n_unknowns();
  }
}

BENCHMARK(clamped_square_plate)
    ->ArgNames({"refinement", "method"})
    ->Args({0, 0})
    ->Args({2, 0})
    ->Unit(benchmark::kSecond)
    ->Iterations(1);

double user_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

/// Least wall and user time of some work on 1 and on 2 threads [s].
struct OnThreads {
  static constexpr double never = std::numeric_limits<double>::infinity();
  double wall[2] = {never, never}, user[2] = {never, never};
  void measure(int threads, const auto& work) {
    use_threads(threads);
    const double before = user_seconds(), seconds = seconds_of(work);
    const auto k = static_cast<std::size_t>(threads - 1);
    wall[k] = std::min(wall[k], seconds);
    user[k] = std::min(user[k], user_seconds() - before);
  }
  void report(benchmark::State& state, const std::string& name) const {
    state.counters[name + ": ms"] = 1e3 * wall[0];
    state.counters[name + ": gain"] = wall[0] / wall[1];
    state.counters[name + ": user"] = user[1] / user[0];
  }
};

/// Forces, tangent and a whole step of a block of 16 x 16 x 16 cells of Q2 (107 811 unknowns), on one and on
/// two threads in turn, three times. Counters: ms on one thread; gain, the wall time of one thread over that
/// of two; user, the processor time of two threads over that of one.
void fem_threads(benchmark::State& state) {
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  SolidBox box;
  box.name = "block";
  box.max << 0.2, 0.2, 0.2;
  box.support[0] = Support::clamped;
  box.material.model = MaterialModel::saint_venant_kirchhoff;
  p.solid = solid_of_boxes(3, {box});
  p.load = {.kind = LoadKind::traction, .value = {0, -1e7, 0}, .face = "top", .at = {}, .ramp = 1e-3};
  p.fem.refinement = 4;
  p.fem.linear_solver = LinearMethod::cg_amg;
  FemSolver<3> solver(p);
  const Assembly<3> assembly(solver.mesh(), p.solid.parts);
  const Eigen::VectorXd u = 1e-5 * Eigen::VectorXd::Random(solver.mesh().n_unknowns());
  const double dt = 1e-5;
  double t = 0;
  OnThreads force, tangent, step;
  for ([[maybe_unused]] auto turn : state)
    for (const int threads : {1, 2}) {
      force.measure(threads, [&] { benchmark::DoNotOptimize(assembly.internal_force(u, u, 0.5)); });
      tangent.measure(threads, [&] { benchmark::DoNotOptimize(assembly.tangent(u)); });
      step.measure(threads, [&] { solver.advance(t += dt, dt, {}); });
    }
  state.counters["unknowns"] = solver.mesh().n_unknowns();
  force.report(state, "force");
  tangent.report(state, "tangent");
  step.report(state, "step");
}

BENCHMARK(fem_threads)->Unit(benchmark::kSecond)->Iterations(3);

}  // namespace

BENCHMARK_MAIN();
