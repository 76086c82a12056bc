#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/UmfPackSupport>
#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace strake::structure::fem {
namespace {

using ColumnMatrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Row by row and column by column the same numbers, but for round-off of their assembly.
bool symmetric(const RowMatrix& rows, const ColumnMatrix& columns) {
  constexpr double round_off = 1e-13;
  return (rows.coeffs() - columns.coeffs()).abs().maxCoeff() <= round_off * rows.coeffs().abs().maxCoeff();
}

/// Factors of matrices of one pattern. A = L Lᵀ by CHOLMOD, supernodal, with dense blocks for BLAS; it orders
/// by nested dissection (METIS) if that fills less. A = L U by UMFPACK, which pivots, so that an indefinite
/// or unsymmetric tangent of large deformation is as good as any other.
///
/// A body in space of 128 547 unknowns, one thread: 5.2 s and 0.6 GiB, against 37 s and 1.7 GiB of UMFPACK; a
/// solve takes 0.08 s against 0.7 s.
class DirectSolver final : public LinearSolver::Method {
 public:
  explicit DirectSolver(bool cholesky) : try_cholesky_(cholesky) {
    cholesky_.cholmod().print = 0;  // its status reports errors
    // UMFPACK's own refinement costs eight times the solve; the residual that Newton's method takes anyway
    // does its work.
    lu_.umfpackControl()(UMFPACK_IRSTEP) = 0;
  }

  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    assert(matrix_.size() == 0 || matrix.nonZeros() == matrix_.nonZeros());
    matrix_ = matrix;
    const bool may_be_definite = try_cholesky_ && symmetric(matrix, matrix_);
    for (Eigen::Index j = 0; j < matrix_.cols(); ++j)
      for (ColumnMatrix::InnerIterator entry(matrix_, j); entry; ++entry) {
        const bool out =
            is_fixed[static_cast<std::size_t>(j)] || is_fixed[static_cast<std::size_t>(entry.row())];
        // The diagonal of a fixed unknown stays, so that the pivots keep their size; zeros keep the pattern.
        if (out && entry.row() != j) entry.valueRef() = 0;
      }
    by_cholesky_ = may_be_definite && definite();
    return by_cholesky_ || regular();
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b, double) override {
    return by_cholesky_ ? Eigen::VectorXd(cholesky_.solve(b)) : Eigen::VectorXd(lu_.solve(b));
  }

 private:
  bool definite() {
    if (!std::exchange(cholesky_analysed_, true)) cholesky_.analyzePattern(matrix_);
    require_room();
    cholesky_.factorize(matrix_);
    require_room();
    return cholesky_.info() == Eigen::Success;
  }
  bool regular() {
    // Minimum degree fills factors of large bodies in space: 37 s at 128 547 unknowns, against 13 s.
    if (matrix_.rows() >= many_unknowns) lu_.umfpackControl()(UMFPACK_ORDERING) = UMFPACK_ORDERING_METIS;
    if (!std::exchange(lu_analysed_, true)) lu_.analyzePattern(matrix_);
    lu_.factorize(matrix_);
    return lu_.info() == Eigen::Success;
  }
  void require_room() {
    if (cholesky_.cholmod().status >= CHOLMOD_OK) return;
    throw Error(
        ExitCode::solver_fault, "structure (fem), Cholesky factors",
        fmt::format("{} unknowns need {:.1f} GiB of factors, and there is no room for them", matrix_.rows(),
                    cholesky_.cholmod().lnz * sizeof(double) / (1024.0 * 1024 * 1024)),
        "structure.fem.linear_solver = \"cg-amg\", or lower structure.fem.refinement");
  }

  bool try_cholesky_, by_cholesky_ = false, cholesky_analysed_ = false, lu_analysed_ = false;
  ColumnMatrix matrix_;  // the LU factors refer to it
  Eigen::CholmodSupernodalLLT<ColumnMatrix, Eigen::Upper> cholesky_;
  Eigen::UmfPackLU<ColumnMatrix> lu_;
};

}  // namespace

std::unique_ptr<LinearSolver::Method> direct_solver(const NodalUnknowns& unknowns) {
  return std::make_unique<DirectSolver>(unknowns.per_node == 3);
}

}  // namespace strake::structure::fem
