#include "tests/benchmark/machine.hpp"

#include <cstdio>
#include <cstdlib>

// Measures the machine, as a reference for the speed of whole commands. machine_benchmark PARTICLES THREADS
// prints the STREAM triad [GB/s] and the milliseconds of one product of a plain sparse matrix with so many
// rows.
int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: machine_benchmark PARTICLES THREADS\n");
    return 2;
  }
  const strake::benchmark_machine::Machine machine(2, std::atol(argv[1]), std::atoi(argv[2]));
  const auto ratios = machine.beside(1);
  std::printf("%.6g %.6g\n", ratios.triad_gb_per_s, ratios.spmv_ms);
}
