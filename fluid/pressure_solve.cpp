#include "fluid/poisson_solver.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace strake::fluid {

namespace {

// Sums are taken over blocks of this many rows, each by one thread, and added in order: the same for any
// number of threads. Four running sums inside a block let the processor overlap them.
constexpr std::int64_t block_size = 512;
// An iteration has three places where threads wait for one another: below this many rows that costs more than
// it brings, and on a busy machine far more.
constexpr std::int64_t rows_for_threads = 30000;

struct Blocks {
  std::int64_t n, count;
  explicit Blocks(std::int64_t rows) : n(rows), count((rows + block_size - 1) / block_size) {}
  std::int64_t begin(std::int64_t b) const { return b * block_size; }
  std::int64_t end(std::int64_t b) const { return std::min(n, (b + 1) * block_size); }
};

double dot(const double* a, const double* b, std::int64_t begin, std::int64_t end) {
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

// (A x)_k
double row_times(const PressureSystem& system, const double* x, std::int64_t k) {
  const std::int64_t begin = system.start[static_cast<std::size_t>(k)];
  const std::int64_t end = system.stop[static_cast<std::size_t>(k)];
  const std::int32_t* column = system.column.data();
  const double* value = system.value.data();
  double s0 = system.diagonal[k] * x[k], s1 = 0, s2 = 0, s3 = 0;
  std::int64_t e = begin;
  for (; e + 4 <= end; e += 4) {
    s0 += value[e] * x[column[e]];
    s1 += value[e + 1] * x[column[e + 1]];
    s2 += value[e + 2] * x[column[e + 2]];
    s3 += value[e + 3] * x[column[e + 3]];
  }
  for (; e < end; ++e) s0 += value[e] * x[column[e]];
  return (s0 + s1) + (s2 + s3);
}

// Conjugate gradients with the diagonal as preconditioner, three passes over the rows per iteration.
PressureSolution solve_jacobi(const PressureSystem& system, const Eigen::VectorXd& guess, double tolerance,
                              int max_iterations) {
  const std::int64_t n = system.size();
  const Blocks blocks(n);
  std::vector<double> first(static_cast<std::size_t>(blocks.count)), second(first), third(first);
  PressureSolution solution{guess, 0, 0};
  Eigen::VectorXd inverse(n), r(n), p(n), q(n);
  double* x = solution.pressure.data();
  const double* b = system.right.data();

#pragma omp parallel for schedule(static) if (n >= rows_for_threads)
  for (std::int64_t block = 0; block < blocks.count; ++block) {
    const std::int64_t begin = blocks.begin(block), end = blocks.end(block);
    for (std::int64_t k = begin; k < end; ++k) {
      inverse[k] = 1.0 / system.diagonal[k];
      r[k] = b[k] - row_times(system, x, k);
      p[k] = inverse[k] * r[k];
    }
    first[static_cast<std::size_t>(block)] = dot(b, b, begin, end);
    second[static_cast<std::size_t>(block)] = dot(r.data(), r.data(), begin, end);
    third[static_cast<std::size_t>(block)] = dot(r.data(), p.data(), begin, end);
  }
  const double b_norm = std::sqrt(ordered_sum(first));
  double r_norm = std::sqrt(ordered_sum(second));
  double rz = ordered_sum(third);
  if (b_norm == 0) {
    solution.pressure.setZero();
    return solution;
  }
  // The negated form also ends the loop when the residual is not a number.
  while (r_norm > tolerance * b_norm && solution.iterations < max_iterations) {
#pragma omp parallel for schedule(static) if (n >= rows_for_threads)
    for (std::int64_t block = 0; block < blocks.count; ++block) {
      for (std::int64_t k = blocks.begin(block); k < blocks.end(block); ++k)
        q[k] = row_times(system, p.data(), k);
      first[static_cast<std::size_t>(block)] =
          dot(p.data(), q.data(), blocks.begin(block), blocks.end(block));
    }
    const double alpha = rz / ordered_sum(first);
#pragma omp parallel for schedule(static) if (n >= rows_for_threads)
    for (std::int64_t block = 0; block < blocks.count; ++block) {
      const std::int64_t begin = blocks.begin(block), end = blocks.end(block);
      for (std::int64_t k = begin; k < end; ++k) {
        x[k] += alpha * p[k];
        r[k] -= alpha * q[k];
        q[k] = inverse[k] * r[k];
      }
      second[static_cast<std::size_t>(block)] = dot(r.data(), r.data(), begin, end);
      third[static_cast<std::size_t>(block)] = dot(r.data(), q.data(), begin, end);
    }
    r_norm = std::sqrt(ordered_sum(second));
    const double rz_new = ordered_sum(third);
    const double beta = rz_new / rz;
    rz = rz_new;
#pragma omp parallel for schedule(static) if (n >= rows_for_threads)
    for (std::int64_t k = 0; k < n; ++k) p[k] = q[k] + beta * p[k];
    ++solution.iterations;
  }
  solution.residual = r_norm / b_norm;
  return solution;
}

Eigen::SparseMatrix<double> to_eigen(const PressureSystem& system) {
  const std::int64_t n = system.size();
  Eigen::SparseMatrix<double> matrix(n, n);
  std::vector<int> count(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < count.size(); ++k)
    count[k] = static_cast<int>(system.stop[k] - system.start[k]) + 1;
  matrix.reserve(count);
  for (std::int64_t k = 0; k < n; ++k) {
    const auto row = static_cast<std::size_t>(k);
    bool diagonal_done = false;
    for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e) {
      const std::int32_t j = system.column[static_cast<std::size_t>(e)];
      if (j > k && !diagonal_done) {
        matrix.insert(k, k) = system.diagonal[k];
        diagonal_done = true;
      }
      matrix.insert(j, k) = system.value[static_cast<std::size_t>(e)];  // symmetric: column k is row k
    }
    if (!diagonal_done) matrix.insert(k, k) = system.diagonal[k];
  }
  matrix.makeCompressed();
  return matrix;
}

PressureSolution solve_incomplete_cholesky(const PressureSystem& system, const Eigen::VectorXd& guess,
                                           double tolerance, int max_iterations) {
  const Eigen::SparseMatrix<double> matrix = to_eigen(system);
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper,
                           Eigen::IncompleteCholesky<double>>
      solver;
  solver.setTolerance(tolerance);
  solver.setMaxIterations(max_iterations);
  solver.compute(matrix);
  PressureSolution solution;
  solution.pressure = solver.solveWithGuess(system.right, guess);
  solution.iterations = static_cast<int>(solver.iterations());
  solution.residual = pressure_residual(system, solution.pressure);
  return solution;
}

PressureSolution solve_direct(const PressureSystem& system) {
  Eigen::CholmodDecomposition<Eigen::SparseMatrix<double>> solver;
  solver.compute(to_eigen(system));
  PressureSolution solution;
  solution.iterations = 1;
  if (solver.info() != Eigen::Success) {
    solution.pressure = Eigen::VectorXd::Zero(system.size());
    solution.residual = std::numeric_limits<double>::infinity();
    return solution;
  }
  solution.pressure = solver.solve(system.right);
  solution.residual = pressure_residual(system, solution.pressure);
  return solution;
}

}  // namespace

double pressure_residual(const PressureSystem& system, const Eigen::VectorXd& pressure) {
  double r2 = 0, b2 = 0;
  for (std::int64_t k = 0; k < system.size(); ++k) {
    const double r = system.right[k] - row_times(system, pressure.data(), k);
    r2 += r * r;
    b2 += system.right[k] * system.right[k];
  }
  return b2 == 0 ? std::sqrt(r2) : std::sqrt(r2 / b2);
}

PressureSolution solve_pressure(const PressureSystem& system, const Eigen::VectorXd& guess,
                                const Scheme& scheme) {
  if (system.size() == 0) return {};
  if (scheme.pressure_solver == PressureSolver::cholmod) return solve_direct(system);
  if (scheme.preconditioner == Preconditioner::ic)
    return solve_incomplete_cholesky(system, guess, scheme.pressure_tolerance,
                                     scheme.pressure_max_iterations);
  return solve_jacobi(system, guess, scheme.pressure_tolerance, scheme.pressure_max_iterations);
}

template <int dim>
const PressureSolution& PoissonSolver<dim>::solve(const PressureSystem& system, const Vectors<dim>&,
                                                  const Eigen::VectorXd& guess, const Scheme& scheme) {
  solution_ = solve_pressure(system, guess, scheme);
  return solution_;
}

template class PoissonSolver<2>;
template class PoissonSolver<3>;

}  // namespace strake::fluid
