#include "tests/benchmark/fluid/library_solvers.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <limits>
#include <vector>

namespace strake::fluid {

namespace {

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

}  // namespace

void solve_incomplete_cholesky(const PressureSystem& system, double tolerance, int max_iterations,
                               PressureSolution& solution) {
  const Eigen::SparseMatrix<double> matrix = to_eigen(system);
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper,
                           Eigen::IncompleteCholesky<double>>
      solver;
  solver.setTolerance(tolerance);
  solver.setMaxIterations(max_iterations);
  solver.compute(matrix);
  const Eigen::VectorXd guess = solution.pressure;
  solution.pressure = solver.solveWithGuess(system.right, guess);
  solution.iterations = static_cast<int>(solver.iterations());
  solution.residual = pressure_residual(system, solution.pressure);
}

void solve_cholmod(const PressureSystem& system, PressureSolution& solution) {
  Eigen::CholmodDecomposition<Eigen::SparseMatrix<double>> solver;
  solver.compute(to_eigen(system));
  solution.iterations = 1;
  if (solver.info() != Eigen::Success) {
    solution.pressure.setZero();
    solution.residual = std::numeric_limits<double>::infinity();
    return;
  }
  solution.pressure = solver.solve(system.right);
  solution.residual = pressure_residual(system, solution.pressure);
}

}  // namespace strake::fluid
