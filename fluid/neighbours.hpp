#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fluid/state.hpp"

namespace strake::fluid {

/// Neighbour rows in compressed form: for particle i the columns row(i), sorted by index, both i-j and j-i stored.
/// Exactly the pairs with |r_ij| < radius at the positions of the last `update`: a Verlet skin saves the cell search,
/// never shows in the rows. Counted first, filled second: no capacity to overflow.
class Neighbours {
 public:
  std::span<const std::int32_t> row(std::int64_t i) const {
    return {column_.data() + start_[static_cast<std::size_t>(i)],
            static_cast<std::size_t>(start_[static_cast<std::size_t>(i) + 1] - start_[static_cast<std::size_t>(i)])};
  }
  std::span<const std::int64_t> start() const { return start_; }     // n+1
  std::span<const std::int32_t> column() const { return column_; }
  std::int64_t size() const { return static_cast<std::int64_t>(start_.size()) - 1; }

 private:
  template <int dim>
  friend class NeighbourSearch;
  std::vector<std::int64_t> start_{0};
  std::vector<std::int32_t> column_;
};

/// Cell list with a Verlet skin. Throws Error(solver_fault) that names the particle when a position is not finite.
template <int dim>
class NeighbourSearch {
 public:
  /// radius: largest interaction radius [m]; skin: [m], 0.2 l0 pays (PHYSICS §16.5).
  NeighbourSearch(double radius, double skin);
  /// `keep(i, j)`: false drops a pair for good reason (dummy–dummy, across a body); must be symmetric.
  const Neighbours& update(const Vectors<dim>& position, const std::function<bool(std::int32_t, std::int32_t)>& keep = {});
  void invalidate();  // after set_state or re-ordering

 private:
  double radius_, skin_;
  Vectors<dim> built_at_;
  Neighbours candidates_, exact_;
};

}  // namespace strake::fluid
