#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#ifdef STRAKE_HAS_ML
#include <Epetra_CrsMatrix.h>
#include <Epetra_Map.h>
#include <Epetra_MpiComm.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>
#include <mpi.h>
#endif

namespace strake::structure::fem {

#ifdef STRAKE_HAS_ML

namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// ML uses MPI, with this process alone, from its first use to the end of the process.
class Session {
 public:
  Session() {
    int started = 0;
    MPI_Initialized(&started);
    own_ = started == 0;
    if (own_) MPI_Init(nullptr, nullptr);
  }
  ~Session() {
    int ended = 0;
    MPI_Finalized(&ended);
    if (own_ && ended == 0) MPI_Finalize();
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  bool own_ = false;
};

Epetra_Vector view(const Epetra_Map& map, const Eigen::VectorXd& x) {
  return Epetra_Vector(View, map, const_cast<double*>(x.data()));
}

/// Conjugate gradients, one V-cycle of smoothed aggregation before each step (Vaněk, Mandel & Brezina 1996).
/// The rigid motions, which elasticity leaves almost without force on every coarse level, stand in its coarse
/// spaces.
class ConjugateGradients final : public LinearSolver::Method {
 public:
  ConjugateGradients(NodalUnknowns unknowns, int most_iterations)
      : unknowns_(std::move(unknowns)), most_iterations_(most_iterations) {
    static const Session session;
  }

  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    multigrid_.reset();
    matrix_.reset();
    const auto n = static_cast<int>(matrix.rows());
    map_ = std::make_unique<Epetra_Map>(n, 0, Epetra_MpiComm(MPI_COMM_SELF));

    // Held unknowns keep their diagonal alone.
    std::vector<int> count(static_cast<std::size_t>(n)), column;
    std::vector<double> value;
    const auto stays = [&](int i, const RowMatrix::InnerIterator& entry) {
      return entry.col() == i ||
             (!is_fixed[static_cast<std::size_t>(i)] && !is_fixed[static_cast<std::size_t>(entry.col())]);
    };
    for (int i = 0; i < n; ++i)
      for (RowMatrix::InnerIterator entry(matrix, i); entry; ++entry)
        count[static_cast<std::size_t>(i)] += stays(i, entry);
    matrix_ = std::make_unique<Epetra_CrsMatrix>(Copy, *map_, *map_, count.data(), true);
    for (int i = 0; i < n; ++i) {
      column.clear();
      value.clear();
      for (RowMatrix::InnerIterator entry(matrix, i); entry; ++entry) {
        if (!stays(i, entry)) continue;
        column.push_back(static_cast<int>(entry.col()));
        value.push_back(entry.value());
      }
      matrix_->InsertMyValues(i, static_cast<int>(column.size()), value.data(), column.data());
    }
    matrix_->FillComplete();
    matrix_->OptimizeStorage();

    // Uses a bound of ‖A‖ for the damping, and Gauss–Seidel, instead of an iteration from a random start. The
    // same matrix then gives the same bits in every call.
    Teuchos::ParameterList keys;
    ML_Epetra::SetDefaults("SA", keys);
    keys.set("ML output", 0);
    keys.set("PDE equations", unknowns_.per_node);
    keys.set("eigen-analysis: type", "Anorm");
    keys.set("smoother: type", "symmetric Gauss-Seidel");
    keys.set("smoother: sweeps", 1);
    keys.set("smoother: pre or post", "both");
    keys.set("coarse: type", "Amesos-KLU");
    keys.set("coarse: max size", 600);
    if (unknowns_.rigid_motions.size() > 0) {
      keys.set("null space: type", "pre-computed");
      keys.set("null space: dimension", static_cast<int>(unknowns_.rigid_motions.cols()));
      keys.set("null space: vectors", unknowns_.rigid_motions.data());
      keys.set("null space: add default vectors", false);
    }
    multigrid_ = std::make_unique<ML_Epetra::MultiLevelPreconditioner>(*matrix_, keys);
    return multigrid_->IsPreconditionerComputed();
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) override {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size()), r = b, z = x, Ap = x;
    iterations_ = 0;
    const double wanted = tolerance * b.norm();
    if (b.norm() == 0) return x;
    Epetra_Vector r_view = view(*map_, r), z_view = view(*map_, z), Ap_view = view(*map_, Ap);
    multigrid_->ApplyInverse(r_view, z_view);
    Eigen::VectorXd p = z;
    const Epetra_Vector p_view = view(*map_, p);
    double rz = r.dot(z);
    while (r.norm() > wanted) {
      matrix_->Multiply(false, p_view, Ap_view);
      const double curvature = p.dot(Ap);
      if (!(curvature > 0) || !(rz > 0))
        throw failed("the matrix is not positive definite: the body buckles, or a cell is turned inside out");
      x += rz / curvature * p;
      r -= rz / curvature * Ap;
      if (++iterations_ == most_iterations_)
        throw failed(
            fmt::format("the residual is {:.2e} of the right side's norm after {} iterations, wanted {:.0e}",
                        r.norm() / b.norm(), iterations_, tolerance));
      multigrid_->ApplyInverse(r_view, z_view);
      const double next = r.dot(z);
      p = z + next / rz * p;
      rz = next;
    }
    return x;
  }

  int iterations() const override { return iterations_; }

 private:
  static Error failed(const std::string& problem) {
    return {ExitCode::solver_fault, "structure (fem), conjugate gradients", problem,
            "structure.fem.linear_solver = \"direct\""};
  }

  NodalUnknowns unknowns_;  // multigrid refers to it
  int most_iterations_;
  std::unique_ptr<Epetra_Map> map_;
  std::unique_ptr<Epetra_CrsMatrix> matrix_;
  std::unique_ptr<ML_Epetra::MultiLevelPreconditioner> multigrid_;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver::Method> conjugate_gradients(const NodalUnknowns& unknowns,
                                                          int most_iterations) {
  return std::make_unique<ConjugateGradients>(unknowns, most_iterations);
}

bool has_conjugate_gradients() {
  return true;
}

#else

std::unique_ptr<LinearSolver::Method> conjugate_gradients(const NodalUnknowns&, int) {
  throw Error(ExitCode::case_file, "structure.fem.linear_solver",
              "cg-amg needs Trilinos ML, and this program was built without",
              "structure.fem.linear_solver = \"direct\", or build with libtrilinos-ml-dev");
}

bool has_conjugate_gradients() {
  return false;
}

#endif

}  // namespace strake::structure::fem
