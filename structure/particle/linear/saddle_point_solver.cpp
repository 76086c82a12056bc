#include "structure/particle/linear/saddle_point_solver.hpp"

#include "proto/error.hpp"

#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace strake::structure {

struct SaddlePointSolver::Factors {
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
};

SaddlePointSolver::SaddlePointSolver() : factors_(std::make_unique<Factors>()) {}
SaddlePointSolver::~SaddlePointSolver() = default;

void SaddlePointSolver::factorise(const Eigen::SparseMatrix<double>& K,
                                  const Eigen::SparseMatrix<double, Eigen::RowMajor>& C) {
  n_ = K.rows();
  const Eigen::Index m = C.rows();
  Eigen::SparseMatrix<double> whole(n_ + m, n_ + m);
  std::vector<Eigen::Triplet<double>> entries;
  double largest = 0;
  for (Eigen::Index c = 0; c < n_; ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(K, c); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(c), entry.value());
      largest = std::max(largest, std::abs(entry.value()));
    }
  for (Eigen::Index r = 0; r < m; ++r)  // as large as K, for the pivots' sake
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(C, r); entry; ++entry) {
      const int row = static_cast<int>(n_ + r), column = static_cast<int>(entry.col());
      entries.emplace_back(row, column, largest * entry.value());
      entries.emplace_back(column, row, largest * entry.value());
    }
  // As in Constraints: equations that say the same twice share their reaction.
  constexpr double shared_out = 1e-12;
  for (Eigen::Index r = n_; r < n_ + m; ++r)
    entries.emplace_back(static_cast<int>(r), static_cast<int>(r), -shared_out * largest);
  whole.setFromTriplets(entries.begin(), entries.end());
  factors_->lu.compute(whole);
  if (factors_->lu.info() != Eigen::Success)
    throw Error(ExitCode::solver_fault, "structure, particle", "the stiffness matrix is singular",
                "hold the body: structure.plate.supports, or supports of a structure.box");
}

Eigen::MatrixXd SaddlePointSolver::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(factors_->lu.rows(), b.cols());
  whole.topRows(n_) = b;
  return Eigen::MatrixXd(factors_->lu.solve(whole)).topRows(n_);
}

}  // namespace strake::structure
