#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <optional>
#include <vector>

namespace strake::structure::fem {
namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Factors on the first of several ranks, of the matrix of the whole body. Its numbers are those of one rank,
/// so that the factors are the same whatever the number of ranks. The other ranks wait meanwhile.
class DirectOnFirst final : public LinearSolver::Method {
 public:
  explicit DirectOnFirst(const NodalUnknowns& unknowns)
      : division_(unknowns.division),
        direct_(direct_solver({.per_node = unknowns.per_node, .rigid_motions = {}})) {}

  bool factorise(const RowMatrix& matrix, const std::vector<char>& is_fixed) override {
    const RowMatrix whole = on_first(matrix);
    const Eigen::VectorXd fixed = division_.whole(
        Eigen::Map<const Eigen::Matrix<char, Eigen::Dynamic, 1>>(is_fixed.data(), matrix.rows())
            .cast<double>());
    constexpr int singular = 0, regular = 1, failed = 2;
    int outcome = singular;
    std::optional<Error> error;
    if (division_.first()) try {
        outcome = direct_->factorise(whole, {fixed.begin(), fixed.end()}) ? regular : singular;
      } catch (const Error& problem) {
        error = problem;
        outcome = failed;
      }
    outcome = static_cast<int>(division_.max(outcome));
    if (outcome == failed)  // the first rank tells why
      throw error.value_or(Error(ExitCode::solver_fault, "structure (fem), factors", "there are none"));
    return outcome == regular;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) override {
    Eigen::VectorXd x = division_.whole(b);
    if (division_.first())
      x = direct_->solve(x, tolerance);
    else
      x.setZero();
    return division_.part(division_.sum(x));
  }

 private:
  /// The matrix of the body, of the ranks' own rows.
  RowMatrix on_first(const RowMatrix& matrix) const {
    const auto own = static_cast<int>(division_.own(matrix.rows()));
    Eigen::MatrixXd entries(3, matrix.outerIndexPtr()[own]);  // row, column, value
    for (int i = 0; i < own; ++i)
      for (int k = matrix.outerIndexPtr()[i]; k < matrix.outerIndexPtr()[i + 1]; ++k)
        entries.col(k) << division_.number(i), division_.number(matrix.innerIndexPtr()[k]),
            matrix.valuePtr()[k];
    entries = division_.columns_on_first(entries);
    std::vector<Eigen::Triplet<double>> triplets;
    for (const auto& entry : entries.colwise())
      triplets.emplace_back(static_cast<int>(entry(0)), static_cast<int>(entry(1)), entry(2));
    RowMatrix whole(division_.size(0), division_.size(0));
    whole.setFromTriplets(triplets.begin(), triplets.end());
    return whole;
  }

  RankDivision division_;
  std::unique_ptr<LinearSolver::Method> direct_;
};

}  // namespace

std::unique_ptr<LinearSolver::Method> direct_on_ranks(const NodalUnknowns& unknowns) {
  return std::make_unique<DirectOnFirst>(unknowns);
}

}  // namespace strake::structure::fem
