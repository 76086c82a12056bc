#include "coupler/acceleration/accelerator.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <malloc.h>
#include <random>
#include <string>
#include <vector>

// Time of one acceleration step for three components on N points. The residuals are independent, so that
// every column is new and the oldest of 20 is dropped each time. Windows of ten iterations, with the copies
// of the state that a scheme makes to be able to rewind. Arguments: points; fields stacked. Counters: columns
// in use; largest heap memory of the accelerator and both copies of its state, in MB and in vectors of all
// values.

namespace {

using namespace strake;
using Eigen::Index;
using Eigen::VectorXd;

/// Bytes that the program has taken from the heap and not given back.
double heap() {
  const auto use = mallinfo2();
  return static_cast<double>(use.uordblks + use.hblkhd);
}

void accelerate(benchmark::State& state, const std::string& kind) {
  const Index n = 3 * state.range(0);
  const int blocks = static_cast<int>(state.range(1));
  constexpr int iterations_per_window = 10, n_pool = 48;  // more than the columns: no two are dependent
  AcceleratorParameters parameters;
  parameters.kind = kind;
  parameters.reused_windows = 100;
  parameters.max_columns = 20;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<VectorXd> pool;
  for (int k = 0; k < n_pool; ++k)
    pool.push_back(VectorXd::NullaryExpr(blocks * n, [&] { return uniform(random); }));

  const double before = heap();
  const auto accelerator = make_accelerator(parameters);
  std::vector<AcceleratorBlock> fields;
  for (int b = 0; b < blocks; ++b) fields.push_back({"field", n});
  accelerator->set_blocks(fields);
  AcceleratorState committed;
  std::size_t k = 0;
  int iteration = 0, columns = 0;
  const auto once = [&] {
    if (iteration++ % iterations_per_window == 0) {
      committed = accelerator->state();
      accelerator->set_state(committed);
      accelerator->start_window();
    }
    benchmark::DoNotOptimize(accelerator->next(pool[k % n_pool], pool[(k + 1) % n_pool]).data());
    ++k;
    columns = accelerator->last_step().columns;
  };
  for (int warm = 0; warm < 40; ++warm) once();
  for (auto _ : state) once();
  double held = 0;
  for (int more = 0; more < iterations_per_window; ++more) {
    once();
    held = std::max(held, heap() - before);
  }
  state.counters["columns"] = columns;
  state.counters["MB"] = held / 1e6;
  state.counters["vectors"] = held / static_cast<double>(blocks * n * 8);
  state.SetItemsProcessed(state.iterations());
}

}  // namespace

BENCHMARK_CAPTURE(accelerate, aitken, "aitken")
    ->ArgsProduct({{41, 1000, 10000, 100000}, {1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(accelerate, iqn_ils, "iqn-ils")
    ->ArgsProduct({{41, 1000, 10000, 100000}, {1, 2}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(accelerate, iqn_imvj, "iqn-imvj")
    ->ArgsProduct({{41, 1000, 10000, 100000}, {1, 2}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
