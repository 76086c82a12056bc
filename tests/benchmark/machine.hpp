#pragma once

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

/// Two measures of the machine, since machines differ; every figure of speed is compared with them. They are
/// STREAM triad and a plain product of a sparse matrix in compressed rows, both with the threads of the work
/// itself.
namespace strake::benchmark_machine {

/// Shortest of `repeats` runs of `work` [s]: what others do on the machine only ever makes a run longer.
template <class Work>
double shortest(int repeats, Work&& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < repeats; ++k) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

/// An array whose pages are first touched by the threads that will use them.
class Array {
 public:
  Array(std::size_t n, double value, int threads) : n_(n), data_(new double[n]) {
    double* data = data_.get();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) data[i] = value;
  }
  double* data() {
    return data_.get();
  }
  std::size_t size() const {
    return n_;
  }

 private:
  std::size_t n_;
  std::unique_ptr<double[]> data_;
};

/// Bandwidth of STREAM triad a = b + s c over arrays of `bytes` in all [B/s]. Three doubles are moved per
/// element (the line fetched before a is written is not counted, as in STREAM). 48 MB: between cache and
/// memory; 600 MB: memory.
inline double triad_bandwidth(int threads, double bytes = 48e6, int repeats = 15) {
  const auto n = static_cast<std::size_t>(bytes / (3 * sizeof(double)));
  Array a(n, 0, threads), b(n, 1, threads), c(n, 2, threads);
  double *x = a.data(), *y = b.data(), *z = c.data();
  volatile double factor = 3;
  const double seconds = shortest(repeats, [&] {
    const double s = factor;
#pragma omp parallel for simd schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) x[i] = y[i] + s * z[i];
  });
  volatile double kept = x[n / 2];
  static_cast<void>(kept);
  return 3.0 * static_cast<double>(n * sizeof(double)) / seconds;
}

/// The matrix of a pressure equation on n particles, in compressed rows. It is the lattice's own graph: cells
/// of a square (2-D) or cube (3-D) with all neighbours within `radius` cells, numbered row by row.
struct CompressedRows {
  std::vector<std::int64_t> begin;
  std::vector<std::int32_t> column;
  std::vector<double> value;
  std::int64_t rows() const { return static_cast<std::int64_t>(begin.size()) - 1; }
  std::int64_t non_zeros() const { return begin.back(); }
};

inline CompressedRows lattice_matrix(int dimension, std::int64_t particles, double radius) {
  std::int64_t side = 1;
  const auto cells = [&](std::int64_t s) { return dimension == 3 ? s * s * s : s * s; };
  while (cells(side) < particles) ++side;
  const int reach = static_cast<int>(radius), deep = dimension == 3 ? reach : 0;
  const std::int64_t layers = dimension == 3 ? side : 1;
  CompressedRows m;
  m.begin.push_back(0);
  for (std::int64_t z = 0; z < layers; ++z)
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x) {
        for (int dz = -deep; dz <= deep; ++dz)
          for (int dy = -reach; dy <= reach; ++dy)
            for (int dx = -reach; dx <= reach; ++dx) {
              const std::int64_t i = x + dx, j = y + dy, k = z + dz;
              if (i < 0 || j < 0 || k < 0 || i >= side || j >= side || k >= layers) continue;
              const double distance2 = dx * dx + dy * dy + dz * dz;
              if (distance2 >= radius * radius) continue;
              m.column.push_back(static_cast<std::int32_t>((k * side + j) * side + i));
              m.value.push_back(distance2 == 0 ? 1.0 : -0.01);
            }
        m.begin.push_back(static_cast<std::int64_t>(m.column.size()));
      }
  return m;
}

/// One product y = A x with a plain loop over compressed rows [s].
inline double spmv_seconds(const CompressedRows& m, int threads, int repeats = 15) {
  const std::int64_t n = m.rows();
  Array in(static_cast<std::size_t>(n), 1, threads), out(static_cast<std::size_t>(n), 0, threads);
  const double* x = in.data();
  double* y = out.data();
  const double seconds = shortest(repeats, [&] {
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::int64_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::int64_t k = m.begin[static_cast<std::size_t>(i)];
           k < m.begin[static_cast<std::size_t>(i) + 1]; ++k)
        sum += m.value[static_cast<std::size_t>(k)] * x[m.column[static_cast<std::size_t>(k)]];
      y[i] = sum;
    }
  });
  volatile double kept = y[n / 2];
  static_cast<void>(kept);
  return seconds;
}

/// What stands beside the seconds of one piece of work on `particles` particles.
struct Ratios {
  double triad_gb_per_s;  // STREAM triad, 48 MB
  double triad_bytes;     // bytes per particle that the triad would have moved in the time of the work
  double spmv_ms;         // one product with the matrix of as many rows, radius 3.1 l0 (2.1 in 3-D)
  double spmvs;           // products that the work's time would have paid for
};

/// Measures the machine once for a size; `beside` then serves any number of figures.
class Machine {
 public:
  Machine(int dimension, std::int64_t particles, int threads)
      : particles_(static_cast<double>(particles)),
        triad_(triad_bandwidth(threads)),
        spmv_(spmv_seconds(lattice_matrix(dimension, particles, dimension == 3 ? 2.1 : 3.1), threads)) {}
  Ratios beside(double seconds) const {
    return {1e-9 * triad_, seconds * triad_ / particles_, 1e3 * spmv_, seconds / spmv_};
  }

 private:
  double particles_, triad_, spmv_;
};

}  // namespace strake::benchmark_machine
