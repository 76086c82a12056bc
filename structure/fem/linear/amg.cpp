#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <Teuchos_ParameterList.hpp>
#include <deal.II/base/partitioner.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>
#include <fmt/format.h>
#include <ml_MultiLevelPreconditioner.h>
#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace strake::structure::fem {

namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Vector = dealii::TrilinosWrappers::MPI::Vector;

/// Begins MPI with this process alone, unless a launcher of ranks has begun it.
void begin_mpi() {
  int begun = 0;
  MPI_Initialized(&begun);
  if (begun != 0) return;
  MPI_Init(nullptr, nullptr);
  std::atexit([] { MPI_Finalize(); });
}

/// A matrix that shows on the way that it is not positive definite: pᵀA p ≤ 0.
struct PositiveMatrix {
  struct Indefinite {};
  const dealii::TrilinosWrappers::SparseMatrix& matrix;
  void vmult(Vector& Ap, const Vector& p) const {
    matrix.vmult(Ap, p);
    if (!(p * Ap > 0)) throw Indefinite();
  }
};

/// Conjugate gradients, one V-cycle of smoothed aggregation before each step (Vaněk, Mandel & Brezina 1996).
/// The rigid motions, which elasticity leaves almost without force on every coarse level, stand in its coarse
/// spaces.
class ConjugateGradients final : public LinearSolver::Method {
 public:
  ConjugateGradients(NodalUnknowns unknowns, int most_iterations)
      : unknowns_(std::move(unknowns)), most_iterations_(static_cast<unsigned int>(most_iterations)) {}

  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    multigrid_.clear();
    const RankDivision& division = unknowns_.division;
    const auto own = static_cast<int>(division.own(matrix.rows()));
    rows_ = division.alone() ? dealii::complete_index_set(static_cast<unsigned int>(own))
                             : division.entries().locally_owned_range();
    const auto global = [&](Eigen::Index i) {
      const auto local = static_cast<unsigned int>(i);
      return division.alone() ? local : division.entries().local_to_global(local);
    };
    // Held unknowns keep their diagonal alone.
    const auto stays = [&](int i, const RowMatrix::InnerIterator& entry) {
      return entry.col() == i ||
             (!is_fixed[static_cast<std::size_t>(i)] && !is_fixed[static_cast<std::size_t>(entry.col())]);
    };
    std::vector<unsigned int> count(static_cast<std::size_t>(own)), column;
    std::vector<double> value;
    for (int i = 0; i < own; ++i)
      for (RowMatrix::InnerIterator entry(matrix, i); entry; ++entry)
        count[static_cast<std::size_t>(i)] += stays(i, entry);
    matrix_ = std::make_unique<dealii::TrilinosWrappers::SparseMatrix>(rows_, communicator(), count);
    for (int i = 0; i < own; ++i) {
      column.clear();
      value.clear();
      for (RowMatrix::InnerIterator entry(matrix, i); entry; ++entry) {
        if (!stays(i, entry)) continue;
        column.push_back(global(entry.col()));
        value.push_back(entry.value());
      }
      matrix_->set(global(i), static_cast<unsigned int>(column.size()), column.data(), value.data());
    }
    matrix_->compress(dealii::VectorOperation::insert);

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
      own_motions_ = unknowns_.rigid_motions.topRows(own);
      keys.set("null space: type", "pre-computed");
      keys.set("null space: dimension", static_cast<int>(own_motions_.cols()));
      keys.set("null space: vectors", own_motions_.data());
      keys.set("null space: add default vectors", false);
    }
    try {
      multigrid_.initialize(*matrix_, keys);
    } catch (const dealii::ExceptionBase&) {
      return false;
    }
    return true;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) override {
    Vector x(rows_, communicator()), right(rows_, communicator());
    std::copy_n(b.data(), right.locally_owned_size(), right.begin());
    const double size = right.l2_norm();
    iterations_ = 0;
    if (size == 0) return Eigen::VectorXd::Zero(b.size());
    dealii::SolverControl control(most_iterations_, tolerance * size);
    try {
      dealii::SolverCG<Vector>(control).solve(PositiveMatrix{*matrix_}, x, right, multigrid_);
    } catch (const PositiveMatrix::Indefinite&) {
      throw failed("the matrix is not positive definite: the body buckles, or a cell is turned inside out");
    } catch (const dealii::SolverControl::NoConvergence& stopped) {
      throw failed(
          fmt::format("the residual is {:.2e} of the right side's norm after {} iterations, wanted {:.0e}",
                      stopped.last_residual / size, stopped.last_step, tolerance));
    }
    iterations_ = static_cast<int>(control.last_step());
    Eigen::VectorXd result = Eigen::VectorXd::Zero(b.size());
    std::copy_n(x.begin(), x.locally_owned_size(), result.data());
    return result;
  }

  int iterations() const override { return iterations_; }

 private:
  static Error failed(const std::string& problem) {
    return {ExitCode::solver_fault, "structure (fem), conjugate gradients", problem,
            "structure.fem.linear_solver = \"direct\""};
  }
  MPI_Comm communicator() const { return unknowns_.division.alone() ? MPI_COMM_SELF : MPI_COMM_WORLD; }

  NodalUnknowns unknowns_;
  unsigned int most_iterations_;
  Eigen::MatrixXd own_motions_;  // multigrid refers to them
  dealii::IndexSet rows_;
  std::unique_ptr<dealii::TrilinosWrappers::SparseMatrix> matrix_;
  dealii::TrilinosWrappers::PreconditionAMG multigrid_;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver::Method> conjugate_gradients(const NodalUnknowns& unknowns,
                                                          int most_iterations) {
  begin_mpi();
  return std::make_unique<ConjugateGradients>(unknowns, most_iterations);
}

}  // namespace strake::structure::fem
