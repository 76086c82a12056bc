#include "structure/fem/linear_solver.hpp"

#include <Eigen/UmfPackSupport>
#include <cassert>

namespace strake::structure::fem {

using ColumnMatrix = Eigen::SparseMatrix<double>;

struct LinearSolver::Parts {
  ColumnMatrix matrix;  // the factors refer to it
  std::vector<int> fixed;
  Eigen::UmfPackLU<ColumnMatrix> factors;
  bool analysed = false;
};

LinearSolver::LinearSolver() : parts_(std::make_unique<Parts>()) {}
LinearSolver::~LinearSolver() = default;

bool LinearSolver::factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix,
                             const std::vector<int>& fixed) {
  Parts& parts = *parts_;
  assert(!parts.analysed || matrix.nonZeros() == parts.matrix.nonZeros());
  parts.matrix = matrix;
  parts.fixed = fixed;
  std::vector<char> is_fixed(static_cast<std::size_t>(matrix.rows()), 0);
  for (const int i : fixed) is_fixed[static_cast<std::size_t>(i)] = 1;
  for (Eigen::Index j = 0; j < parts.matrix.cols(); ++j)
    for (ColumnMatrix::InnerIterator entry(parts.matrix, j); entry; ++entry) {
      const bool out =
          is_fixed[static_cast<std::size_t>(j)] || is_fixed[static_cast<std::size_t>(entry.row())];
      // The diagonal of a fixed unknown stays, so that the pivots keep their size; zeros keep the pattern.
      if (out && entry.row() != j) entry.valueRef() = 0;
    }
  if (!parts.analysed) {
    // UMFPACK's own refinement costs eight times the solve; the residual that Newton's method takes anyway
    // does its work.
    parts.factors.umfpackControl()(UMFPACK_IRSTEP) = 0;
    parts.factors.analyzePattern(parts.matrix);
    parts.analysed = true;
  }
  parts.factors.factorize(parts.matrix);
  return parts.factors.info() == Eigen::Success;
}

Eigen::VectorXd LinearSolver::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd right = b;
  for (const int i : parts_->fixed) right(i) = 0;
  Eigen::VectorXd x = parts_->factors.solve(right);
  for (const int i : parts_->fixed) x(i) = 0;
  return x;
}

}  // namespace strake::structure::fem
