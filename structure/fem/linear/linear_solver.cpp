#include "structure/fem/linear/linear_solver.hpp"

#include "proto/error.hpp"

#include <utility>

namespace strake::structure::fem {
namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Iterations: of one that the user asked for, and of one that has factors behind it. A cube takes 24, a bar
// of four widths 80, a plate of a hundredth of its width in thickness some hundreds to thousands.
constexpr int patience = 2000, patience_before_direct = 300;

/// Conjugate gradients, and factors of the same matrix where they do not come to an end.
class IterationOrDirect final : public LinearSolver::Method {
 public:
  IterationOrDirect(const NodalUnknowns& unknowns, std::shared_ptr<GivenUp> given_up)
      : given_up_(given_up ? std::move(given_up) : std::make_shared<GivenUp>()),
        iteration_(conjugate_gradients(unknowns, patience_before_direct)),
        direct_(direct_solver(unknowns)) {}

  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    matrix_ = matrix;
    is_fixed_ = is_fixed;
    direct_at_hand_ = false;
    iterates_ = multigrid_at_hand_ = iteration_->factorise(matrix, is_fixed);
    return iterates_ || give_up("multigrid cannot be set up");
  }

  void retry() override { iterates_ = multigrid_at_hand_; }

  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) override {
    if (!iterates_) return direct_->solve(b, tolerance);
    try {
      return iteration_->solve(b, tolerance);
    } catch (const Error& error) {
      if (!give_up(error.problem()))
        throw Error(ExitCode::solver_fault, "structure (fem), linear systems",
                    "conjugate gradients: " + error.problem() + "; factors: the matrix is singular",
                    "hold the body by more supports, or lower the load");
    }
    return direct_->solve(b, tolerance);
  }

  int iterations() const override { return iterates_ ? iteration_->iterations() : 0; }

 private:
  bool give_up(const std::string& why) {
    if (given_up_->times++ == 0) given_up_->why = why;
    iterates_ = false;
    if (!direct_at_hand_) direct_at_hand_ = direct_->factorise(matrix_, is_fixed_);
    return direct_at_hand_;
  }

  std::shared_ptr<GivenUp> given_up_;
  std::unique_ptr<LinearSolver::Method> iteration_, direct_;
  RowMatrix matrix_;
  std::vector<char> is_fixed_;
  bool iterates_ = false, multigrid_at_hand_ = false, direct_at_hand_ = false;
};

std::unique_ptr<LinearSolver::Method> make(LinearMethod method, const NodalUnknowns& unknowns,
                                           std::shared_ptr<GivenUp> given_up) {
  if (method == LinearMethod::cg_amg) return conjugate_gradients(unknowns, patience);
  if (method == LinearMethod::automatic)
    return std::make_unique<IterationOrDirect>(unknowns, std::move(given_up));
  return unknowns.division.alone() ? direct_solver(unknowns) : direct_on_ranks(unknowns);
}

}  // namespace

LinearSolver::LinearSolver(LinearMethod method, const NodalUnknowns& unknowns,
                           std::shared_ptr<GivenUp> given_up)
    : division_(unknowns.division), method_(make(method, unknowns, std::move(given_up))) {}
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
  division_.update(x);
  return x;
}

int LinearSolver::iterations() const {
  return method_->iterations();
}

// Chooses a method by size. Measured with one thread on a cube of 108 000 unknowns: 6.3 s and 0.7 GiB of
// factors, and 0.1 s for each solve. 24 iterations of conjugate gradients take 7 s. Factors grow with the
// power 4/3 of the unknowns, their work with the square: 2.1 GiB and a minute at the size from which an
// iteration is tried first.
LinearMethod chosen(LinearMethod asked, int dimension, int unknowns) {
  constexpr int too_many_for_factors = 250000;
  if (asked != LinearMethod::automatic) return asked;
  const bool iterate = dimension == 3 && unknowns >= too_many_for_factors;
  return iterate ? LinearMethod::automatic : LinearMethod::direct;
}

}  // namespace strake::structure::fem
