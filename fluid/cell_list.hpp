#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fluid/periodic.hpp"
#include "fluid/state.hpp"

namespace strake::fluid {

/// Room for n entries that are all written anew: the old ones are given back before new memory is taken, and
/// little is held in reserve.
template <class T>
void make_room(std::vector<T>& values, std::size_t n) {
  if (n > values.capacity()) {
    std::vector<T>().swap(values);
    values.reserve(n + n / 16);
  }
  values.resize(n);
}

/// Rows that hold every pair within a reach and a few beyond it, sorted by index. A bit marks the pairs at
/// the border: those that a motion within the skin may take over the radius, and those that nearly coincide.
/// All others are within the radius as long as the rows are valid.
struct Candidates {
  std::vector<std::int64_t> start{0};  // n+1
  std::vector<std::int32_t> column;
  std::vector<std::uint64_t> border;  // one bit per pair, each row from a word of its own

  std::size_t bytes() const { return 8 * start.capacity() + 4 * column.capacity() + 8 * border.capacity(); }
  std::int64_t length(std::int64_t i) const {
    return start[static_cast<std::size_t>(i) + 1] - start[static_cast<std::size_t>(i)];
  }
  const std::int32_t* columns(std::int64_t i) const {
    return column.data() + start[static_cast<std::size_t>(i)];
  }
  /// First word of row i: a row of m pairs has room for ⌈m/64⌉.
  std::size_t word(std::int64_t i) const {
    return static_cast<std::size_t>(start[static_cast<std::size_t>(i)] / 64 + i);
  }
};

/// Cells no smaller than the reach, so that all partners of a particle are in its own or an adjacent cell.
/// Each cell gets one list of the particles in and around it, in the order of their indices: particle after
/// particle is appended to the lists of the cells around it. Rows cut out of such a list are sorted without
/// sorting.
///
/// Particles outside the grid belong to its edge cells: clamping two cell numbers never moves them apart, so
/// the search stays right and a far flyer costs time, never memory.
template <int dim>
class CellList {
 public:
  /// Every pair nearer than radius + skin but those of two fillers (tag & 1); tag may be empty. lists: memory
  /// that nobody needs while it works.
  void find(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double radius, double skin,
            const Periodic<dim>&, Candidates&, std::vector<std::int32_t>& lists);
  /// Cell of each particle of the last `find`, numbered along x first, then y, then z.
  std::span<const std::int32_t> cells() const { return cell_; }

  std::size_t bytes() const {
    return 4 * (cell_.capacity() + members_.capacity() + occupied_.capacity()) +
           8 * (list_start_.capacity() + next_.capacity() + bits_start_.capacity());
  }

 private:
  using Place = std::array<std::int32_t, 3>;
  void lay_grid(const Vectors<dim>& position, double reach, const Periodic<dim>&);
  Place place(const double* x) const;
  std::int32_t number(const Place& p) const { return (p[2] * count_[1] + p[1]) * count_[0] + p[0]; }
  Place place_of(std::int32_t cell) const;
  Vector<dim> centre(const Place&) const;
  template <class Body>
  void around(const Place&, Body&&) const;
  void fill_lists(const Vectors<dim>& position, std::vector<std::int32_t>& lists);

  std::array<double, 3> origin_{}, size_{1, 1, 1};
  std::array<std::int32_t, 3> count_{1, 1, 1};
  std::array<bool, 3> seam_{};
  std::vector<std::int32_t> cell_;        // of each particle
  std::vector<std::int32_t> members_;     // particles in each cell
  std::vector<std::int32_t> occupied_;    // cells with members
  std::vector<std::int64_t> list_start_;  // of each occupied cell
  std::vector<std::int64_t> next_;        // of each cell: end of its list so far; −1: none
  // Of each occupied cell, behind the lists: of each member against the list, sixteen partners at a time.
  std::vector<std::int64_t> bits_start_;
};

}  // namespace strake::fluid
