#pragma once

#include "fluid/pressure_solver/sparse_row.hpp"
#include "fluid/pressure_solver/thread_team.hpp"

#include <Eigen/Cholesky>

#include <array>
#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Sparse rows without the diagonal. Single precision is enough for a preconditioner.
struct SparseRows {
  std::vector<std::int32_t> start{0}, column;
  std::vector<float> value;
  std::int32_t rows() const { return static_cast<std::int32_t>(start.size()) - 1; }
  void clear() {
    start.assign(1, 0);
    column.clear();
    value.clear();
  }
  /// Returns (this · x)_i.
  float times(const float* x, std::int64_t i) const {
    return row_sum(value.data(), column.data(), x, start.data()[i], start.data()[i + 1]);
  }
};

/// Joins the rows that each thread made of its part.
void join(const std::vector<SparseRows>& parts, SparseRows& whole);

/// Gathers one row of a sum entry by entry; entries of equal column are added. Columns stay in the order of
/// their first entry: the same for the same input.
class RowGatherer {
 public:
  void resize(std::int64_t columns) {
    if (place_.size() < static_cast<std::size_t>(columns))
      place_.resize(static_cast<std::size_t>(columns), -1);
  }
  void add(std::int32_t column, double value) {
    std::int32_t& at = place_[static_cast<std::size_t>(column)];
    if (at < 0) {
      at = static_cast<std::int32_t>(column_.size());
      column_.push_back(column);
      value_.push_back(value);
    } else {
      value_[static_cast<std::size_t>(at)] += value;
    }
  }
  /// Appends the row without its diagonal to `rows`, and starts anew. Returns the diagonal.
  double finish(std::int32_t row, SparseRows& rows);

 private:
  std::vector<std::int32_t> place_, column_;  // place_: of a column in this row, −1: none
  std::vector<double> value_;
};

/// Returns the inverse of the diagonal, with Jacobi's damping ω. The sweep then contracts for any symmetric
/// positive definite A: λ(D⁻¹A) <= 2 ω < 2 by Gershgorin's circles.
inline double damped_inverse(double diagonal, double off_diagonal_sum, double damping) {
  const double d = std::max(diagonal, 0.5 * (diagonal + off_diagonal_sum)) / damping;
  return d > 0 ? 1 / d : 0;
}

/// One level of the hierarchy above the particles: unknowns at the vertices of a grid of square cells. A
/// vertex has one unknown for each connected set of the water around it, so that no pressure leaks from one
/// side of a plate to the other.
template <int dim>
struct CoarseLevel {
  using Place = std::array<std::int32_t, dim>;
  std::array<std::int32_t, 3> size{1, 1, 1};  // vertices per axis
  std::vector<Place> place;                   // of each unknown; those of one vertex stand together
  std::vector<std::int32_t> first;            // per vertex, and one more: its first unknown
  SparseRows matrix;
  std::vector<float> diagonal, inverse;
  SparseRows restriction;   // row: unknown of the next level
  SparseRows prolongation;  // its transpose
  std::vector<float> right, solution, rest;

  std::int32_t unknowns() const { return static_cast<std::int32_t>(place.size()); }
  /// Computes `inverse` from `matrix` and `diagonal`, and makes room for the vectors.
  void prepare();
  /// Makes the next level: multilinear interpolation from the vertices with even numbers, and its Galerkin
  /// operator. Returns false when the next level would have more than 0.8 of the unknowns.
  bool coarsen(CoarseLevel& next, int threads);

 private:
  /// Memory of the search for connected sets. slot: of each unknown, −1 not reached, 0 reached, 1 in a set.
  /// reached, part: unknowns.
  struct Search {
    std::vector<std::int32_t> slot, reached = {}, part = {};
  };
  /// Adds one vertex of the next level. It has an unknown for each connected set of the unknowns that it
  /// reaches, and each has its row of the restriction.
  void add_vertex(const std::array<std::int32_t, 3>& vertex, CoarseLevel& next, Search&);
  /// Computes next.matrix and next.diagonal by the Galerkin product R A Rᵀ.
  void multiply_out(CoarseLevel& next, int threads) const;
};

/// Levels from the finest grid to one that is solved directly.
template <int dim>
class GridCycle {
 public:
  CoarseLevel<dim>& finest() { return levels_.front(); }
  const CoarseLevel<dim>& finest() const { return levels_.front(); }
  /// Builds the levels above the finest.
  void build(int threads);
  /// Computes finest().solution ≈ A⁻¹ finest().right by one symmetric V-cycle. All threads of the team call
  /// it; it ends without a wait.
  void cycle(const Team& team) { descend(0, team); }
  std::size_t bytes() const;
  int levels() const { return used_; }

 private:
  void descend(std::size_t level, const Team&);
  void solve_last();
  std::vector<CoarseLevel<dim>> levels_{1};
  int used_ = 1;
  Eigen::LLT<Eigen::MatrixXd> factor_;  // of the last level
  Eigen::VectorXd dense_;
  bool direct_ = false;
};

}  // namespace strake::fluid
