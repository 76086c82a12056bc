#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/aggregates.hpp"
#include "fluid/pressure_solver/coarse_level.hpp"
#include "fluid/pressure_solver/grid_ranks.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/pressure_solver/thread_team.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Approximates A⁻¹ by a symmetric positive definite operator. It is one sweep of damped Jacobi on the
/// particles, a correction from a grid, and a second sweep. The cells of the grid are as wide as the reach of
/// A; pressure is linear between their vertices. The grid's equation is solved by the same scheme on ever
/// coarser grids. The operator is a pure function of system and places, built anew for each solve. Single
/// precision is enough for a preconditioner.
template <int dim>
class Multilevel {
 public:
  /// radius: reach of A [m]; reach: the same in spacings.
  void build(const PressureSystem&, const Vectors<dim>& position, double radius, double reach, int threads);
  /// The same on several ranks, whose grids are one. system: the rows of the unknowns in cells; full:
  /// unknowns of a full cell.
  void build(const PressureSystem&, const RankedUnknowns<dim>&, GridRanks<dim>&, double full, int threads);
  /// Computes z ≈ A⁻¹ r. The caller writes r to right(), and D⁻¹ r to swept(); z is in solution(). Each
  /// thread of the team calls it after a wait, and its own share of z is ready when it returns.
  void apply(const PressureSystem&, const Team&);
  float* right() { return right_.data(); }
  float* swept() { return swept_.data(); }
  const float* inverse() const { return inverse_.data(); }  // damped D⁻¹
  const float* solution() const { return solution_.data(); }

  int levels() const { return grids_.levels() + 1; }
  std::size_t bytes() const;

 private:
  static constexpr int corners = Aggregates<dim>::corners;
  static constexpr int moments = dim * (dim + 1) / 2;
  using Element = std::array<double, static_cast<std::size_t>(corners) * corners>;

  std::int64_t vertices() const {  // with those that have no row here
    return grid_ranks_ ? grid_ranks_->numbers() : grids_.finest().unknowns();
  }
  bool is_copy(std::int64_t unknown) const {
    return unknowns_ &&
           unknowns_->owner[static_cast<std::size_t>(unknown)] != unknowns_->communicator->rank();
  }
  void make_grid(const PressureSystem&, int threads);
  void solve_grid(const Team&);
  void update_copies(const Team&);
  void read_rows(const PressureSystem&, int threads);
  Element element(std::int32_t piece) const;
  bool is_exact(std::int64_t i, std::int64_t j) const;
  void read_scattered_row(const PressureSystem&, std::int64_t k);
  void read_exact_entries(const PressureSystem&, int threads);
  void add_exact_entries(std::int32_t piece, std::int32_t corner, RowGatherer&) const;
  void assemble_grid(int threads);

  Aggregates<dim> pieces_;
  GridCycle<dim> grids_;
  std::vector<Element> elements_;                   // of each piece
  std::vector<SparseRows> parts_;                   // of the grid's rows, one per thread
  std::vector<float> diagonal_, inverse_, excess_;  // excess: of the diagonal over its row
  std::array<std::vector<float>, moments> moment_;  // ½ Σ w r rᵀ, in cells: xx, xy, yy (xx, xy, xz, …)
  std::vector<std::int32_t> scattered_;             // unknowns with entries that `is_exact`
  std::vector<std::int32_t> exact_row_;             // of each unknown, −1: none
  SparseRows exact_;  // Σ w (P_i − P_j) over those entries of scattered unknown i
  std::array<std::vector<float>, dim> within_;  // place in its cell, in the order of the pieces
  std::vector<float> right_, swept_, solution_;
  std::vector<float> corner_sum_;  // per corner of each piece
  // On several ranks; null: one rank.
  const RankedUnknowns<dim>* unknowns_ = nullptr;
  GridRanks<dim>* grid_ranks_ = nullptr;
};

}  // namespace strake::fluid
