#include "tests/algebra/factors.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseLU>

namespace strake {

Eigen::VectorXd solution_of(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.llt().solve(b);
}

bool is_positive_definite(const Eigen::MatrixXd& a) {
  return a.llt().info() == Eigen::Success;
}

struct SparseFactors::Factors : Eigen::SparseLU<Eigen::SparseMatrix<double>> {};

SparseFactors::SparseFactors() : factors_(std::make_unique<Factors>()) {}
SparseFactors::~SparseFactors() = default;

bool SparseFactors::compute(const Eigen::SparseMatrix<double>& matrix) {
  factors_->compute(matrix);
  return factors_->info() == Eigen::Success;
}

Eigen::VectorXd SparseFactors::solve(const Eigen::VectorXd& right) const {
  return factors_->solve(right);
}

}  // namespace strake
