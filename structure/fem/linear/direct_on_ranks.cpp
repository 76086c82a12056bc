#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

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
    if (slot_.size() == 0) find_pattern(matrix);
    const auto values = gathered<double>(std::span(matrix.valuePtr(), entries_of_own_rows(matrix)));
    const auto own = static_cast<std::size_t>(division_.own(matrix.rows()));
    const auto fixed = gathered<char>(std::span(is_fixed.data(), own));
    Outcome outcome = Outcome::singular;
    std::optional<Error> error;
    if (division_.first()) {
      for (Eigen::Index k = 0; k < whole_.nonZeros(); ++k)
        whole_.valuePtr()[k] = values[static_cast<std::size_t>(slot_.valuePtr()[k])];
      std::vector<char> fixed_of_body(fixed.size());
      for (std::size_t i = 0; i < fixed.size(); ++i)
        fixed_of_body[static_cast<std::size_t>(number_[i])] = fixed[i];
      try {
        outcome = direct_->factorise(whole_, fixed_of_body) ? Outcome::regular : Outcome::singular;
      } catch (const Error& problem) {
        error = problem;
        outcome = Outcome::failed;
      }
    }
    outcome = static_cast<Outcome>(division_.max(static_cast<double>(outcome)));
    if (outcome == Outcome::failed)  // the first rank tells why
      throw error.value_or(Error(ExitCode::solver_fault, "structure (fem), factors", "there are none"));
    return outcome == Outcome::regular;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b, double tolerance) override {
    const auto own = static_cast<std::size_t>(division_.own(b.size()));
    const auto right = gathered<double>(std::span(b.data(), own));
    std::vector<Bytes> parts(static_cast<std::size_t>(division_.communicator().size()));
    if (division_.first()) {
      Eigen::VectorXd of_body(number_.size());
      for (std::size_t i = 0; i < right.size(); ++i) of_body(number_[i]) = right[i];
      of_body = direct_->solve(of_body, tolerance);
      auto number = number_.begin();
      for (std::size_t r = 0; r < parts.size(); ++r)
        for (std::int64_t i = 0; i < owned_[r]; ++i) append(parts[r], of_body(*number++));
    }
    const std::vector<double> mine = values_of<double>(division_.communicator().exchange_any(parts).front());
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
    std::ranges::copy(mine, x.begin());
    return x;
  }

 private:
  enum class Outcome { singular, regular, failed };

  std::size_t entries_of_own_rows(const RowMatrix& matrix) const {
    return static_cast<std::size_t>(matrix.outerIndexPtr()[division_.own(matrix.rows())]);
  }

  /// The values of all ranks on the first one, one rank after the other.
  template <class T>
  std::vector<T> gathered(std::span<const T> own) const {
    std::vector<T> all;
    for (const Bytes& bytes : division_.on_first(std::as_bytes(own)))
      std::ranges::copy(values_of<T>(bytes), std::back_inserter(all));
    return all;
  }

  /// The matrix of the body without values, and for each of its entries the place in what the ranks send.
  void find_pattern(const RowMatrix& matrix) {
    const auto own = static_cast<int>(division_.own(matrix.rows()));
    owned_ = division_.communicator().all(std::int64_t{own});
    std::vector<int> number, row, column;
    for (int i = 0; i < own; ++i) {
      number.push_back(division_.number(i));
      for (RowMatrix::InnerIterator entry(matrix, i); entry; ++entry) {
        row.push_back(number.back());
        column.push_back(division_.number(static_cast<int>(entry.col())));
      }
    }
    number_ = gathered<int>(number);
    row = gathered<int>(row);
    column = gathered<int>(column);
    slot_.resize(division_.size(0), division_.size(0));
    if (!division_.first()) return;
    std::vector<Eigen::Triplet<int>> entries;
    for (std::size_t k = 0; k < row.size(); ++k) entries.emplace_back(row[k], column[k], static_cast<int>(k));
    slot_.setFromTriplets(entries.begin(), entries.end());
    whole_ = slot_.cast<double>();
  }

  RankDivision division_;
  std::unique_ptr<LinearSolver::Method> direct_;
  // On the first rank:
  std::vector<std::int64_t> owned_;                 // unknowns of each rank
  std::vector<int> number_;                         // in the body, of the unknowns of all ranks
  Eigen::SparseMatrix<int, Eigen::RowMajor> slot_;  // where each entry stands in what the ranks send
  RowMatrix whole_;
};

}  // namespace

std::unique_ptr<LinearSolver::Method> direct_on_ranks(const NodalUnknowns& unknowns) {
  return std::make_unique<DirectOnFirst>(unknowns);
}

}  // namespace strake::structure::fem
