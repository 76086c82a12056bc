#include "fluid/pressure_solver/conjugate_gradients.hpp"

#include "fluid/pressure_solver/sparse_row.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace {

constexpr std::int64_t block_size = 512;

struct Blocks {
  std::int64_t n, count;
  explicit Blocks(std::int64_t rows) : n(rows), count((rows + block_size - 1) / block_size) {}
  std::int64_t begin(std::int64_t b) const { return b * block_size; }
  std::int64_t end(std::int64_t b) const { return std::min(n, (b + 1) * block_size); }
};

/// Four running sums let the processor overlap them.
template <class A, class B>
double dot(const A* a, const B* b, std::int64_t begin, std::int64_t end) {
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  std::int64_t k = begin;
  for (; k + 4 <= end; k += 4) {
    s0 += a[k] * b[k];
    s1 += a[k + 1] * b[k + 1];
    s2 += a[k + 2] * b[k + 2];
    s3 += a[k + 3] * b[k + 3];
  }
  for (; k < end; ++k) s0 += a[k] * b[k];
  return (s0 + s1) + (s2 + s3);
}

double ordered_sum(const std::vector<double>& partial) {
  double sum = 0;
  for (const double value : partial) sum += value;
  return sum;
}

inline double times(const PressureSystem& system, const double* x, std::int64_t k) {
  return system.diagonal.data()[k] * x[k] +
         row_sum(system.value.data(), system.column.data(), x, system.start.data()[k], system.stop.data()[k]);
}

}  // namespace

double row_times(const PressureSystem& system, const double* x, std::int64_t k) {
  return times(system, x, k);
}

template <int dim>
void ConjugateGradients::solve(const PressureSystem& system, Multilevel<dim>* preconditioner,
                               double tolerance, int max_iterations, int threads,
                               PressureSolution& solution) {
  const std::int64_t n = system.size();
  const Blocks blocks(n);
  for (auto* sums : {&first_, &second_, &third_}) sums->resize(static_cast<std::size_t>(blocks.count));
  solution.iterations = 0;
  double* const inverse = memory_.of<double>(4 * static_cast<std::size_t>(n)).data();
  double *const x = solution.pressure.data(), *const r = inverse + n, *const p = r + n, *const q = p + n;
  const double* b = system.right.data();
  Barrier barrier(threads);

#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    const Team team{omp_get_thread_num(), omp_get_num_threads(), &barrier};
    const auto [first_block, last_block] = team.share(blocks.count);
    const std::int64_t begin = blocks.begin(first_block), end = std::min(n, blocks.begin(last_block));

    for (std::int64_t block = first_block; block < last_block; ++block) {
      const std::int64_t from = blocks.begin(block), to = blocks.end(block);
      for (std::int64_t k = from; k < to; ++k) {
        inverse[k] = 1.0 / system.diagonal[k];
        r[k] = b[k] - times(system, x, k);
        q[k] = inverse[k] * r[k];
      }
      const auto at = static_cast<std::size_t>(block);
      first_[at] = dot(b, b, from, to);
      second_[at] = dot(r, r, from, to);
      third_[at] = dot(r, q, from, to);
    }
    team.wait();
    const double b_norm = std::sqrt(ordered_sum(first_));
    double r_norm = std::sqrt(ordered_sum(second_));
    double rz = 0;
    int iterations = 0;
    if (b_norm == 0) {
      for (std::int64_t k = begin; k < end; ++k) x[k] = 0;
      r_norm = 0;
    }
    const double relative = b_norm > 0 ? 1 / b_norm : 1;  // keeps single precision away from its limits
    // The negated form also ends the loop when the residual is not a number.
    while (r_norm > tolerance * b_norm && iterations < max_iterations) {
      double rz_new = 0;
      if (preconditioner) {
        float *right = preconditioner->right(), *swept = preconditioner->swept();
        const float* damped = preconditioner->inverse();
        for (std::int64_t k = begin; k < end; ++k) {
          right[k] = static_cast<float>(r[k] * relative);
          swept[k] = damped[k] * right[k];
        }
        team.wait();
        preconditioner->apply(system, team);
        team.wait();
        const float* z = preconditioner->solution();
        for (std::int64_t block = first_block; block < last_block; ++block)
          third_[static_cast<std::size_t>(block)] = dot(r, z, blocks.begin(block), blocks.end(block));
        team.wait();
        rz_new = ordered_sum(third_);
        const double beta = iterations == 0 ? 0 : rz_new / rz;
        if (iterations == 0)
          for (std::int64_t k = begin; k < end; ++k) p[k] = z[k];
        else
          for (std::int64_t k = begin; k < end; ++k) p[k] = z[k] + beta * p[k];
      } else {
        rz_new = ordered_sum(third_);
        const double beta = rz_new / rz;
        if (iterations == 0)
          for (std::int64_t k = begin; k < end; ++k) p[k] = q[k];
        else
          for (std::int64_t k = begin; k < end; ++k) p[k] = q[k] + beta * p[k];
      }
      rz = rz_new;
      team.wait();
      for (std::int64_t block = first_block; block < last_block; ++block) {
        const std::int64_t from = blocks.begin(block), to = blocks.end(block);
        for (std::int64_t k = from; k < to; ++k) q[k] = times(system, p, k);
        first_[static_cast<std::size_t>(block)] = dot(p, q, from, to);
      }
      team.wait();
      const double alpha = rz / ordered_sum(first_);
      for (std::int64_t block = first_block; block < last_block; ++block) {
        const std::int64_t from = blocks.begin(block), to = blocks.end(block);
        const auto at = static_cast<std::size_t>(block);
        if (preconditioner) {
          for (std::int64_t k = from; k < to; ++k) {
            x[k] += alpha * p[k];
            r[k] -= alpha * q[k];
          }
        } else {
          for (std::int64_t k = from; k < to; ++k) {
            x[k] += alpha * p[k];
            r[k] -= alpha * q[k];
            q[k] = inverse[k] * r[k];
          }
          third_[at] = dot(r, q, from, to);
        }
        second_[at] = dot(r, r, from, to);
      }
      team.wait();
      r_norm = std::sqrt(ordered_sum(second_));
      ++iterations;
    }
    if (team.first()) {
      solution.iterations = iterations;
      solution.residual = b_norm > 0 ? r_norm / b_norm : r_norm;
    }
  }
}

template void ConjugateGradients::solve<2>(const PressureSystem&, Multilevel<2>*, double, int, int,
                                           PressureSolution&);
template void ConjugateGradients::solve<3>(const PressureSystem&, Multilevel<3>*, double, int, int,
                                           PressureSolution&);

}  // namespace strake::fluid
