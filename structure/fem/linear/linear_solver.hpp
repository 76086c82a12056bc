#pragma once

#include "structure/body/parameters.hpp"
#include "structure/fem/mesh/rank_division.hpp"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <memory>
#include <string>
#include <vector>

namespace strake::structure::fem {

/// Properties of the unknowns that a method can use.
struct NodalUnknowns {
  int per_node = 1;               // 3: a body in space
  Eigen::MatrixXd rigid_motions;  // one per column
  RankDivision division = {};     // among ranks
};

/// How often factors replaced conjugate gradients that were chosen automatically, and why the first time.
struct GivenUp {
  int times = 0;
  std::string why;
};

/// Solves A x = b for matrices of one pattern, some of whose unknowns are constrained. On several ranks each
/// has its own rows, and all solve together.
class LinearSolver {
 public:
  /// `direct`: Cholesky factors where A is symmetric and positive definite and there are three unknowns per
  /// node, LU factors else. `cg_amg`: conjugate gradients with multigrid. `automatic`: the same, and once
  /// they fail, factors of the same matrix, counted in GivenUp.
  explicit LinearSolver(LinearMethod = LinearMethod::direct, const NodalUnknowns& = {},
                        std::shared_ptr<GivenUp> = nullptr);
  ~LinearSolver();
  LinearSolver(LinearSolver&&) noexcept;
  LinearSolver& operator=(LinearSolver&&) noexcept;
  /// Factorises a matrix without the rows and columns of `fixed` unknowns. False when it is singular. Throws
  /// Error(solver_fault) where there is no room for its factors.
  bool factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>&, const std::vector<int>& fixed);
  /// Solves A x = b; x is zero in the fixed unknowns for any b. An iteration stops at ‖b − A x‖₂ ≤ tolerance
  /// ‖b‖₂ over the free unknowns; `cg_amg` throws Error(solver_fault) if it does not converge.
  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance = 1e-12) const;
  /// `automatic`: the next solve iterates again, so that what follows does not depend on what was solved
  /// before.
  void retry() { method_->retry(); }
  int iterations() const;  // of the last solve; 0: direct

  class Method {
   public:
    virtual ~Method() = default;
    virtual bool factorise(const Eigen::SparseMatrix<double, Eigen::RowMajor>&,
                           const std::vector<char>& is_fixed) = 0;
    virtual Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) = 0;
    virtual void retry() {}
    virtual int iterations() const { return 0; }
  };

 private:
  std::vector<int> fixed_;
  RankDivision division_;
  std::unique_ptr<Method> method_;
};

/// Sparse factors, in direct_solver.cpp.
std::unique_ptr<LinearSolver::Method> direct_solver(const NodalUnknowns&);

/// The same on the first of several ranks, in direct_on_ranks.cpp.
std::unique_ptr<LinearSolver::Method> direct_on_ranks(const NodalUnknowns&);

/// Conjugate gradients with smoothed aggregation, in amg.cpp, of at most so many iterations.
std::unique_ptr<LinearSolver::Method> conjugate_gradients(const NodalUnknowns&, int most_iterations);

/// From here on what costs the most in a body of three dimensions are its factors.
inline constexpr int many_unknowns = 60000;

/// Resolves `automatic` by the size and dimension of a mesh alone. So the choice is the same on every
/// machine. It stays `automatic` where conjugate gradients are tried first.
LinearMethod chosen(LinearMethod, int dimension, int unknowns);

}  // namespace strake::structure::fem
