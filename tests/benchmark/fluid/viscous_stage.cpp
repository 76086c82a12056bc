#include "fluid/viscosity/viscous_stage.hpp"

#include "tests/fluid/lattice.hpp"

#include <benchmark/benchmark.h>

// The viscous and sub-particle-scale terms of one step on one thread: a block of water with some disorder.
// Arguments: particles along an edge; model (0 none, 1 static, 2 k).

namespace {
using namespace strake::fluid;

template <int dim>
void viscous(benchmark::State& state) {
  constexpr double l0 = 0.01;
  Parameters p;
  p.dimension = dim;
  p.spacing = l0;
  p.scheme.turbulence = state.range(1) == 0   ? Turbulence::none
                        : state.range(1) == 1 ? Turbulence::statics
                                              : Turbulence::k;
  const Vectors<dim> x = block<dim>(static_cast<int>(state.range(0)), l0, 0.1);
  Vectors<dim> u = Vectors<dim>::Zero(dim, x.cols());
  u.row(0) = (200 * x.row(1)).array().sin();
  NeighbourSearch<dim> search(3.1 * l0, 0);
  const Neighbours& far = search.update(x);
  const Neighbours& near = search.within(2.1 * l0);
  WallLayers<dim> walls;
  walls.resize(x.cols(), 0);
  Eigen::VectorXd k = Eigen::VectorXd::Zero(x.cols());
  ViscousStage<dim> stage;
  for ([[maybe_unused]] auto step : state) stage.compute(p, {x, u, near, far, walls}, 1e-5, k);
  state.counters["particles"] = static_cast<double>(x.cols());
}

}  // namespace

BENCHMARK(viscous<2>)
    ->Args({107, 0})
    ->Args({107, 1})
    ->Args({107, 2})
    ->Args({316, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(viscous<3>)->Args({47, 1})->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
