#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "structure/parameters.hpp"

namespace strake::structure::fem {

/// What a method can be told of the unknowns.
struct NodalUnknowns {
  int per_node = 1;
  Eigen::MatrixXd rigid_motions;  // one per column
};

/// Solves A x = b for matrices of one pattern, some of whose unknowns are held.
class LinearSolver {
 public:
  explicit LinearSolver(LinearMethod = LinearMethod::direct, const NodalUnknowns& = {});
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;
  /// Makes ready for a matrix with the rows and columns of `fixed` unknowns taken out. False when it is
  /// singular.
  bool factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>&, const std::vector<int>& fixed);
  /// x of A x = b, zero in the fixed unknowns, whatever b says there. An iteration stops at
  /// ‖b − A x‖₂ ≤ tolerance ‖b‖₂ over the free unknowns, or throws Error(solver_fault) where it does not come
  /// there.
  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance = 1e-12) const;
  int iterations() const;  // of the last solve; 0: direct

  class Method {
   public:
    virtual ~Method() = default;
    virtual bool factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>&,
                           const std::vector<char>& is_fixed) = 0;
    virtual Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) = 0;
    virtual int iterations() const { return 0; }
  };

 private:
  std::vector<int> fixed_;
  std::unique_ptr<Method> method_;
};

/// Conjugate gradients with smoothed aggregation, in amg.cpp. Throws Error(case_file) where the program was
/// built without Trilinos.
std::unique_ptr<LinearSolver::Method> conjugate_gradients(const NodalUnknowns&);

/// What `automatic` means for a mesh: by its size and dimension alone, so that it is the same on every
/// machine.
LinearMethod chosen(LinearMethod, int dimension, int unknowns);

}  // namespace strake::structure::fem
