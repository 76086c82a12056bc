#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

namespace strake::structure::fem {

/// A sparse LU factorisation by UMFPACK, for matrices of one pattern. It pivots, so that an indefinite or
/// unsymmetric tangent of large deformation is as good as any other.
class LinearSolver {
 public:
  LinearSolver();
  ~LinearSolver();
  /// Factorises the matrix with the rows and columns of `fixed` unknowns taken out. False when it is
  /// singular.
  bool factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>&, const std::vector<int>& fixed);
  /// x of A x = b, zero in the fixed unknowns, whatever b says there.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace strake::structure::fem
