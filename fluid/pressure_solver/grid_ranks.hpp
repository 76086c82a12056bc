#pragma once

#include "fluid/pressure_solver/aggregates.hpp"
#include "fluid/pressure_solver/ranked_unknowns.hpp"
#include "fluid/ranks/shared_grid.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace strake::fluid {

/// Numbers the unknowns of the first grid across ranks, and lets its equation be solved. A vertex belongs to
/// the owner of the lowest piece around it.
template <int dim>
class GridRanks {
 public:
  explicit GridRanks(std::unique_ptr<SharedGrid> solver) : solver_(std::move(solver)) {}
  /// Numbers the vertices around own pieces. Those around copied pieces get numbers behind them, in `node` of
  /// the pieces.
  void number(const RankedUnknowns<dim>&, Aggregates<dim>&);
  /// Numbers of vertices in `node`, with those that have no row here.
  std::int64_t numbers() const { return static_cast<std::int64_t>(number_.size()); }
  void build(const CoarseLevel<dim>&);
  /// Computes grid.solution from grid.right, which holds the sums over own pieces.
  void solve(CoarseLevel<dim>& grid);

 private:
  void number_own(const Aggregates<dim>&);
  /// Sends what is known of the corners of own pieces to the ranks that have copies, and returns the same of
  /// all copied pieces, −1 for others.
  std::vector<std::int64_t> exchange_corners(const RankedUnknowns<dim>&, const Aggregates<dim>&);
  void number_foreign(const Aggregates<dim>&, const std::vector<std::int64_t>& corner);
  void number_beyond(Aggregates<dim>&, const std::vector<std::int64_t>& corner);
  void list_halo(const Aggregates<dim>&);

  std::unique_ptr<SharedGrid> solver_;
  Communicator* communicator_ = nullptr;
  std::int64_t first_ = 0;               // number of the first own vertex
  std::vector<std::int32_t> own_nodes_;  // in their order
  std::vector<std::int64_t> number_;     // for all ranks, of each local one
  Halo nodes_;
  std::vector<float> right_, solution_;  // of the own vertices
};

}  // namespace strake::fluid
