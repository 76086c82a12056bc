#pragma once

#include <Eigen/SparseCore>

#include <memory>

// Eigen's factors of matrices, compiled once for all tests: their templates are long to compile.

namespace strake {

/// x of A x = b by L Lᵀ. A is symmetric and positive definite.
Eigen::VectorXd solution_of(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// Whether a symmetric matrix is: only then L Lᵀ exists.
bool is_positive_definite(const Eigen::MatrixXd&);

/// L U of a sparse square matrix.
class SparseFactors {
 public:
  SparseFactors();
  ~SparseFactors();
  /// Returns false where the matrix is singular.
  bool compute(const Eigen::SparseMatrix<double>&);
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

}  // namespace strake
