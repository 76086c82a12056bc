#include "fluid/diagnostics/voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace strake::fluid {
namespace {

/// Reach from a surface particle within which there is outer air. The middle of the nearest cell of air is at
/// most 2.5 l0 away along an axis, because cells next to a particle are covered. A void is 5 l0 deeper.
constexpr std::int64_t reach = 7;  // [l0], and cells

/// Blocks in the box around all particles: 2 GB of their numbers, 5e11 cells in the plane, 2.6e11 in space.
constexpr double most_blocks = 5e8;

enum Cell : std::uint8_t { empty, covered, air, seen };

/// Cells of l0 around the particles, in blocks. A block with a covered cell has a byte per cell. Any other
/// block is empty or air as a whole. So the memory follows the water and not the box around it.
template <int dim>
class Grid {
 public:
  Grid(const State<dim>& state, std::span<const std::int64_t> water, double spacing)
      : state_(state), spacing_(spacing) {
    for (std::size_t i = 0; i < state.kind.size(); ++i)
      if (state.kind[i] != Kind::fluid) particles_.push_back(static_cast<std::int64_t>(i));
    particles_.insert(particles_.end(), water.begin(), water.end());
    low_ = high_ = state.position.col(particles_.front());
    for (const std::int64_t i : particles_) {
      low_ = low_.cwiseMin(state.position.col(i));
      high_ = high_.cwiseMax(state.position.col(i));
    }
  }

  /// Marks the cells at particles as covered. Returns false if there are too many blocks.
  bool cover() {
    double count = 1;
    for (std::size_t d = 0; d < dim; ++d) {
      const auto axis = static_cast<Eigen::Index>(d);
      const double across =
          std::floor((high_[axis] - low_[axis]) / spacing_) + (d == 1 ? 4 : 1);  // room above
      count *= std::ceil(across / side);
      if (!(count <= most_blocks)) return false;
      size_[d] = static_cast<std::int64_t>(across);
      blocks_[d] = (size_[d] + side - 1) / side;
    }
    block_.assign(static_cast<std::size_t>(count), whole(empty));
    for (const std::int64_t i : particles_) {
      const Place at = cell_of(i);
      for_each_in(from(at, 1), to(at, 1), [&](const Place& p) { cell_at_own_byte(p) = covered; });
    }
    return true;
  }

  /// Marks as air all cells that are connected with the cells above all particles.
  void fill_from_above() {
    for_each_in({0, size_[1] - 1, 0}, {size_[0], size_[1], size_[2]}, [&](const Place& p) { fill(p, air); });
  }
  /// Marks the largest of all connected spaces as air; of several as large, the one with the first cell.
  void fill_largest() {
    Space largest;
    for_each_block([&](const Place& low, const Place& high) {
      const auto take = [&](const Place& p) {
        const Space space = fill(p, seen);
        if (space.cells > largest.cells ||
            (space.cells == largest.cells && number(space.first) < number(largest.first)))
          largest = space;
      };
      if (block_[block_of(low)] < 0)
        take(low);
      else
        for_each_in(low, high, take);
    });
    std::replace(cell_.begin(), cell_.end(), std::uint8_t{seen}, std::uint8_t{empty});
    std::replace(block_.begin(), block_.end(), whole(seen), whole(empty));
    if (largest.cells > 0) fill(largest.first, air);
  }

  bool near_air(std::int64_t particle) const {
    const Place at = cell_of(particle), low = from(at, reach), high = to(at, reach);
    for (std::int64_t z = low[2]; z < high[2]; ++z)
      for (std::int64_t y = low[1]; y < high[1]; ++y)
        for (std::int64_t x = low[0]; x < high[0];) {  // a block's part of the row at once
          const std::int64_t end = std::min(high[0], (x / side + 1) * side);
          const std::int32_t block = block_[block_of({x, y, z})];
          if (block == whole(air)) return true;
          if (block >= 0) {
            const std::uint8_t* const row = cell_.data() + byte_of(block, {x, y, z});
            if (std::find(row, row + (end - x), air) != row + (end - x)) return true;
          }
          x = end;
        }
    return false;
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  /// A connected space: the number of its cells, and that of them with the lowest number.
  struct Space {
    std::int64_t cells = 0;
    Place first{};
  };
  static constexpr std::int64_t side = dim == 2 ? 32 : 8;  // of a block [cells]
  static constexpr std::int64_t bytes = dim == 2 ? side * side : side * side * side;
  static constexpr std::int32_t whole(Cell value) { return -1 - value; }  // of blocks without bytes

  std::int64_t number(const Place& p) const { return (p[2] * size_[1] + p[1]) * size_[0] + p[0]; }
  std::size_t block_of(const Place& p) const {
    return static_cast<std::size_t>((p[2] / side * blocks_[1] + p[1] / side) * blocks_[0] + p[0] / side);
  }
  std::size_t byte_of(std::int32_t block, const Place& p) const {
    return static_cast<std::size_t>(block * bytes + ((p[2] % side) * side + p[1] % side) * side +
                                    p[0] % side);
  }
  Place cell_of(std::int64_t i) const {
    Place place{};
    for (int d = 0; d < dim; ++d)
      place[static_cast<std::size_t>(d)] =
          static_cast<std::int64_t>((state_.position(d, i) - low_[d]) / spacing_);
    return place;
  }
  Place from(Place at, std::int64_t width) const {
    for (std::size_t d = 0; d < dim; ++d) at[d] = std::max<std::int64_t>(at[d] - width, 0);
    return at;
  }
  Place to(Place at, std::int64_t width) const {  // one beyond
    for (std::size_t d = 0; d < 3; ++d) at[d] = std::min(at[d] + (d < dim ? width : 0) + 1, size_[d]);
    return at;
  }
  template <class Visit>
  static void for_each_in(const Place& low, const Place& high, Visit&& visit) {
    for (std::int64_t z = low[2]; z < high[2]; ++z)
      for (std::int64_t y = low[1]; y < high[1]; ++y)
        for (std::int64_t x = low[0]; x < high[0]; ++x) visit(Place{x, y, z});
  }
  /// Calls visit(low, high) with the first cell of each block and the place one beyond its last.
  template <class Visit>
  void for_each_block(Visit&& visit) const {
    for_each_in({}, blocks_, [&](const Place& block) {
      const Place low{block[0] * side, block[1] * side, block[2] * side};
      visit(low, to(low, side - 1));
    });
  }
  /// The byte of a cell. Gives its block bytes where it has none; those outside the grid are covered.
  std::uint8_t& cell_at_own_byte(const Place& p) {
    std::int32_t& block = block_[block_of(p)];
    if (block < 0) {
      block = static_cast<std::int32_t>(cell_.size() / static_cast<std::size_t>(bytes));
      cell_.resize(cell_.size() + static_cast<std::size_t>(bytes), covered);
      const Place low = first_in_block(p);
      for_each_in(low, to(low, side - 1), [&](const Place& q) { cell_[byte_of(block, q)] = empty; });
    }
    return cell_[byte_of(block, p)];
  }
  Place first_in_block(Place p) const {
    for (std::int64_t& along : p) along -= along % side;
    return p;
  }
  /// Gives that value to an empty cell, or to its block where that is empty as a whole, and notes it.
  void take(const Place& p, Cell value, Space& space) {
    std::int32_t& block = block_[block_of(p)];
    Place at = p;
    std::int64_t cells = 1;
    if (block == whole(empty)) {
      block = whole(value);
      at = first_in_block(p);
      const Place end = to(at, side - 1);
      cells = (end[0] - at[0]) * (end[1] - at[1]) * (end[2] - at[2]);
    } else if (block >= 0 && cell_[byte_of(block, p)] == empty) {
      cell_[byte_of(block, p)] = value;
    } else {
      return;
    }
    if (space.cells == 0 || number(at) < number(space.first)) space.first = at;
    space.cells += cells;
    open_.push_back(at);
  }
  /// Gives that value to all empty cells connected with one. Blocks that are empty as a whole are one step.
  Space fill(const Place& start, Cell value) {
    Space space;
    take(start, value, space);
    while (!open_.empty()) {
      const Place low = open_.back();
      open_.pop_back();
      const bool is_whole = block_[block_of(low)] < 0;
      const Place high = to(low, is_whole ? side - 1 : 0);
      for (std::size_t d = 0; d < dim; ++d)
        for (const std::int64_t beside : {low[d] - 1, high[d]}) {
          if (beside < 0 || beside >= size_[d]) continue;
          Place first = low, last = high;  // of the face there
          first[d] = beside;
          last[d] = beside + 1;
          if (block_[block_of(first)] < 0) last = {first[0] + 1, first[1] + 1, first[2] + 1};
          for_each_in(first, last, [&](const Place& p) { take(p, value, space); });
        }
    }
    return space;
  }

  const State<dim>& state_;
  double spacing_;
  std::vector<std::int64_t> particles_;
  Vector<dim> low_, high_;
  Place size_{1, 1, 1}, blocks_{1, 1, 1};  // of the grid [cells], [blocks]
  std::vector<std::int32_t> block_;        // the number of a block with bytes; else whole(value)
  std::vector<std::uint8_t> cell_;         // block by block
  std::vector<Place> open_;
};

}  // namespace

template <int dim>
std::optional<Voids> count_voids(const State<dim>& state, std::span<const std::int64_t> water, double spacing,
                                 bool open_top) {
  Voids voids;
  if (water.empty()) return voids;
  Grid<dim> grid(state, water, spacing);
  if (!grid.cover()) return std::nullopt;
  if (open_top)
    grid.fill_from_above();
  else
    grid.fill_largest();
  for (const std::int64_t i : water) {
    const auto k = static_cast<std::size_t>(i);
    if (state.surface[k] == 0 || grid.near_air(i)) continue;
    ++voids.all;
    if (state.air_connected[k] == 0) ++voids.internal_voids;
  }
  return voids;
}

template <int dim>
void follow_air(State<dim>& state, const Neighbours& near, std::int64_t water,
                std::vector<std::uint8_t>& scratch) {
  scratch.resize(static_cast<std::size_t>(water));
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < water; ++i) {
    const auto k = static_cast<std::size_t>(i);
    std::uint8_t air_connected = state.air_connected[k];
    if (!state.surface[k]) {
      air_connected = 0;
    } else if (!air_connected) {
      const auto columns = near.row(i);
      for (std::size_t e = 0; e < columns.size() && columns[e] < water && !air_connected; ++e)
        air_connected = state.air_connected[static_cast<std::size_t>(columns[e])];
      if (columns.empty()) air_connected = 1;  // alone in the air
    }
    scratch[k] = air_connected;
  }
  std::copy(scratch.begin(), scratch.end(), state.air_connected.begin());
}

#define STRAKE_INSTANTIATE(dim)                                                                            \
  template std::optional<Voids> count_voids<dim>(const State<dim>&, std::span<const std::int64_t>, double, \
                                                 bool);                                                    \
  template void follow_air<dim>(State<dim>&, const Neighbours&, std::int64_t, std::vector<std::uint8_t>&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
