#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>

namespace strake::structure {

/// Solves K x + Cᵀλ = b, C x = 0: the supports' equations beside those of the particles, by LU factors.
class SaddlePointSolver {
 public:
  SaddlePointSolver();
  ~SaddlePointSolver();
  /// Throws Error(solver_fault) where the matrix is singular.
  void factorise(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double, Eigen::RowMajor>& C);
  /// x of each column of b.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
  Eigen::Index n_ = 0;  // rows of K
};

}  // namespace strake::structure
