#include "structure/fem/linear_solver.hpp"

#include <Eigen/UmfPackSupport>
#include <cassert>

namespace strake::structure::fem {
namespace {

using ColumnMatrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A sparse LU factorisation by UMFPACK. It pivots, so that an indefinite or unsymmetric tangent of large
/// deformation is as good as any other.
class Direct final : public LinearSolver::Method {
 public:
  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    assert(!analysed_ || matrix.nonZeros() == matrix_.nonZeros());
    matrix_ = matrix;
    for (Eigen::Index j = 0; j < matrix_.cols(); ++j)
      for (ColumnMatrix::InnerIterator entry(matrix_, j); entry; ++entry) {
        const bool out =
            is_fixed[static_cast<std::size_t>(j)] || is_fixed[static_cast<std::size_t>(entry.row())];
        // The diagonal of a fixed unknown stays, so that the pivots keep their size; zeros keep the pattern.
        if (out && entry.row() != j) entry.valueRef() = 0;
      }
    if (!analysed_) {
      // UMFPACK's own refinement costs eight times the solve; the residual that Newton's method takes anyway
      // does its work.
      factors_.umfpackControl()(UMFPACK_IRSTEP) = 0;
      factors_.analyzePattern(matrix_);
      analysed_ = true;
    }
    factors_.factorize(matrix_);
    return factors_.info() == Eigen::Success;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b, double) override { return factors_.solve(b); }

 private:
  ColumnMatrix matrix_;  // the factors refer to it
  Eigen::UmfPackLU<ColumnMatrix> factors_;
  bool analysed_ = false;
};

std::unique_ptr<LinearSolver::Method> make(LinearMethod method, const NodalUnknowns& unknowns) {
  if (method == LinearMethod::cg_amg) return conjugate_gradients(unknowns);
  return std::make_unique<Direct>();
}

}  // namespace

LinearSolver::LinearSolver(LinearMethod method, const NodalUnknowns& unknowns)
    : method_(make(method, unknowns)) {}
LinearSolver::~LinearSolver() = default;
LinearSolver::LinearSolver(LinearSolver&&) noexcept = default;
LinearSolver& LinearSolver::operator=(LinearSolver&&) noexcept = default;

bool LinearSolver::factorise(const RowMatrix& matrix, const std::vector<int>& fixed) {
  fixed_ = fixed;
  std::vector<char> is_fixed(static_cast<std::size_t>(matrix.rows()), 0);
  for (const int i : fixed) is_fixed[static_cast<std::size_t>(i)] = 1;
  return method_->factorise(matrix, is_fixed);
}

Eigen::VectorXd LinearSolver::solve(const Eigen::VectorXd& b, double tolerance) const {
  Eigen::VectorXd right = b;
  for (const int i : fixed_) right(i) = 0;
  Eigen::VectorXd x = method_->solve(right, tolerance);
  for (const int i : fixed_) x(i) = 0;
  return x;
}

int LinearSolver::iterations() const {
  return method_->iterations();
}

LinearMethod chosen(LinearMethod asked, int dimension, int unknowns) {
  constexpr int many = 60000;  // from here on factors of a body of three dimensions cost more
  if (asked != LinearMethod::automatic) return asked;
  return dimension == 3 && unknowns >= many ? LinearMethod::cg_amg : LinearMethod::direct;
}

}  // namespace strake::structure::fem
