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

/// Returns a·b over [begin, end). The processor overlaps four running sums.
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

/// The data of one thread: its blocks of rows, and the vectors and partial sums that all threads share.
struct ThreadShare {
  const PressureSystem& system;
  const Blocks& blocks;
  const Team& team;
  double *x, *r, *p, *q, *inverse;  // pressure, residual, direction, A p (before: z), 1/diagonal
  double *first, *second, *third;   // partial sums of each block
  std::int64_t first_block, last_block, begin, end;
  const SolvingRanks* ranks;  // nullptr: one rank
  double* joined;             // a sum of all ranks
};

/// Adds up the partial sums of all blocks, and of all ranks.
double total(const ThreadShare& s, const std::vector<double>& partial) {
  if (s.ranks == nullptr) return ordered_sum(partial);
  if (s.team.first()) *s.joined = s.ranks->communicator.sum(ordered_sum(partial));
  s.team.wait();
  const double sum = *s.joined;
  s.team.wait();
  return sum;
}

/// Gives the copies of other ranks' unknowns their values in x.
void update_copies(const ThreadShare& s, double* x) {
  if (s.ranks == nullptr) return;
  if (s.team.first()) s.ranks->halo.update(s.ranks->communicator, x);
  s.team.wait();
}

/// Computes r = b − A p₀, z = D⁻¹ r, and the partial sums b·b, r·r, r·z.
void first_residual(const ThreadShare& s) {
  update_copies(s, s.x);
  const double* b = s.system.right.data();
  for (std::int64_t block = s.first_block; block < s.last_block; ++block) {
    const std::int64_t from = s.blocks.begin(block), to = s.blocks.end(block);
    for (std::int64_t k = from; k < to; ++k) {
      s.inverse[k] = s.system.diagonal[k] != 0 ? 1.0 / s.system.diagonal[k] : 0.0;  // 0: of a copy
      s.r[k] = b[k] - times(s.system, s.x, k);
      s.q[k] = s.inverse[k] * s.r[k];
    }
    s.first[block] = dot(b, b, from, to);
    s.second[block] = dot(s.r, s.r, from, to);
    s.third[block] = dot(s.r, s.q, from, to);
  }
}

/// Computes p = z + β p, in the first iteration p = z.
template <class Real>
void new_direction(const ThreadShare& s, const Real* z, double beta, bool is_first) {
  if (is_first)
    for (std::int64_t k = s.begin; k < s.end; ++k) s.p[k] = z[k];
  else
    for (std::int64_t k = s.begin; k < s.end; ++k) s.p[k] = z[k] + beta * s.p[k];
}

/// Computes z = M⁻¹ r by the multilevel preconditioner, in single precision, and the partial sums r·z.
/// relative: 1/|b|, which scales r so that single precision neither overflows nor underflows.
template <int dim>
void precondition(const ThreadShare& s, Multilevel<dim>& preconditioner, double relative) {
  float *right = preconditioner.right(), *swept = preconditioner.swept();
  const float* damped = preconditioner.inverse();
  for (std::int64_t k = s.begin; k < s.end; ++k) {
    right[k] = static_cast<float>(s.r[k] * relative);
    swept[k] = damped[k] * right[k];
  }
  s.team.wait();
  preconditioner.apply(s.system, s.team);
  s.team.wait();
  for (std::int64_t block = s.first_block; block < s.last_block; ++block)
    s.third[block] = dot(s.r, preconditioner.solution(), s.blocks.begin(block), s.blocks.end(block));
  s.team.wait();
}

/// Computes the next direction and returns r·z:
///   p = z + β p, β = r·z / (r·z of the iteration before).
/// z comes from the preconditioner, or is D⁻¹ r where there is none. In the first iteration p = z.
template <int dim>
double next_direction(const ThreadShare& s, Multilevel<dim>* preconditioner, double relative,
                      const std::vector<double>& third, double rz_before) {
  if (preconditioner) precondition(s, *preconditioner, relative);
  const double rz = total(s, third);
  if (preconditioner)
    new_direction(s, preconditioner->solution(), rz / rz_before, rz_before == 0);
  else
    new_direction(s, s.q, rz / rz_before, rz_before == 0);
  return rz;
}

/// Computes q = A p, and the partial sums p·q.
void multiply(const ThreadShare& s) {
  update_copies(s, s.p);
  for (std::int64_t block = s.first_block; block < s.last_block; ++block) {
    const std::int64_t from = s.blocks.begin(block), to = s.blocks.end(block);
    for (std::int64_t k = from; k < to; ++k) s.q[k] = times(s.system, s.p, k);
    s.first[block] = dot(s.p, s.q, from, to);
  }
}

/// Computes x += α p, r −= α q, and the partial sums r·r. With the diagonal alone it also computes z = D⁻¹ r
/// (in q) and r·z.
void advance(const ThreadShare& s, double alpha, bool diagonal_alone) {
  for (std::int64_t block = s.first_block; block < s.last_block; ++block) {
    const std::int64_t from = s.blocks.begin(block), to = s.blocks.end(block);
    if (diagonal_alone) {
      for (std::int64_t k = from; k < to; ++k) {
        s.x[k] += alpha * s.p[k];
        s.r[k] -= alpha * s.q[k];
        s.q[k] = s.inverse[k] * s.r[k];
      }
      s.third[block] = dot(s.r, s.q, from, to);
    } else {
      for (std::int64_t k = from; k < to; ++k) {
        s.x[k] += alpha * s.p[k];
        s.r[k] -= alpha * s.q[k];
      }
    }
    s.second[block] = dot(s.r, s.r, from, to);
  }
}

}  // namespace

double row_times(const PressureSystem& system, const double* x, std::int64_t k) {
  return times(system, x, k);
}

template <int dim>
void ConjugateGradients::solve(const PressureSystem& system, Multilevel<dim>* preconditioner,
                               double tolerance, int max_iterations, int threads, PressureSolution& solution,
                               const SolvingRanks* ranks) {
  const std::int64_t n = system.size();
  const Blocks blocks(n);
  double joined = 0;
  for (auto* sums : {&first_, &second_, &third_}) sums->resize(static_cast<std::size_t>(blocks.count));
  solution.iterations = 0;
  double* const inverse = memory_.of<double>(4 * static_cast<std::size_t>(n)).data();
  double *const x = solution.pressure.data(), *const r = inverse + n, *const p = r + n, *const q = p + n;
  Barrier barrier(threads);

#pragma omp parallel num_threads(threads) if (threads > 1)
  {
    const Team team{omp_get_thread_num(), omp_get_num_threads(), &barrier};
    const auto [first_block, last_block] = team.share(blocks.count);
    const ThreadShare share{.system = system,
                            .blocks = blocks,
                            .team = team,
                            .x = x,
                            .r = r,
                            .p = p,
                            .q = q,
                            .inverse = inverse,
                            .first = first_.data(),
                            .second = second_.data(),
                            .third = third_.data(),
                            .first_block = first_block,
                            .last_block = last_block,
                            .begin = blocks.begin(first_block),
                            .end = std::min(n, blocks.begin(last_block)),
                            .ranks = ranks,
                            .joined = &joined};
    first_residual(share);
    team.wait();
    const double b_norm = std::sqrt(total(share, first_));
    double r_norm = std::sqrt(total(share, second_)), rz = 0;
    int iterations = 0;
    if (b_norm == 0) {
      std::fill(x + share.begin, x + share.end, 0.0);
      r_norm = 0;
    }
    const double relative = b_norm > 0 ? 1 / b_norm : 1;
    // The negated form also ends the loop when the residual is not a number.
    while (r_norm > tolerance * b_norm && iterations < max_iterations) {
      rz = next_direction(share, preconditioner, relative, third_, iterations == 0 ? 0 : rz);
      team.wait();
      multiply(share);
      team.wait();
      advance(share, rz / total(share, first_), !preconditioner);
      team.wait();
      r_norm = std::sqrt(total(share, second_));
      ++iterations;
    }
    if (team.first()) {
      solution.iterations = iterations;
      solution.residual = b_norm > 0 ? r_norm / b_norm : r_norm;
    }
  }
}

template void ConjugateGradients::solve<2>(const PressureSystem&, Multilevel<2>*, double, int, int,
                                           PressureSolution&, const SolvingRanks*);
template void ConjugateGradients::solve<3>(const PressureSystem&, Multilevel<3>*, double, int, int,
                                           PressureSolution&, const SolvingRanks*);

}  // namespace strake::fluid
