#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Makes room for n entries that are all written anew. The old ones are freed before new memory is allocated,
/// with little reserve.
template <class T>
void make_room(std::vector<T>& values, std::size_t n) {
  if (n > values.capacity()) {
    std::vector<T>().swap(values);
    values.reserve(n + n / 16);
  }
  values.resize(n);
}

/// Candidate pairs as bit masks over the cell's sorted neighbour list. The list contains the particles in and
/// around the cell in the order of their indices. A second bit marks pairs near the cut-off, and pairs that
/// nearly coincide: those are tested again each step. All others stay within the radius while no particle
/// moves by more than the skin allows.
struct Candidates {
  std::vector<std::int32_t> lists;        // of the occupied cells, one behind the other
  std::vector<std::int64_t> list_start;   // of each, and the end
  std::vector<std::int32_t> cell;         // occupied cell of each particle
  std::vector<std::uint32_t> bits;        // sixteen partners each: low half near, high half border as well
  std::vector<std::uint32_t> bits_start;  // of each particle

  std::size_t bytes() const {
    return 4 * (lists.capacity() + cell.capacity() + bits.capacity() + bits_start.capacity()) +
           8 * list_start.capacity();
  }
  /// Returns the list to which particle i's bits refer.
  std::span<const std::int32_t> list(std::int64_t i) const {
    const auto c = static_cast<std::size_t>(cell[static_cast<std::size_t>(i)]);
    return {lists.data() + list_start[c], static_cast<std::size_t>(list_start[c + 1] - list_start[c])};
  }
  std::size_t first_bits(std::int64_t i) const { return bits_start[static_cast<std::size_t>(i)]; }
};

/// Sorts particles into cells no smaller than the reach. All partners of a particle are then in its own or an
/// adjacent cell. Each cell gets one list of the particles in and around it, in the order of their indices:
/// particle after particle is appended to the lists of the cells around it. Rows that are selected from such
/// a list are sorted without sorting, and a row needs two bits per entry of the list.
///
/// Particles outside the grid belong to its edge cells. Clamping two cell numbers never moves them apart, so
/// the search stays right. A far particle costs time, never memory.
template <int dim>
class CellList {
 public:
  /// Finds every pair nearer than radius + skin, except pairs of two fillers (tag & 1). tag may be empty.
  void find(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double radius, double skin,
            const Periodic<dim>&, Candidates&);

  std::size_t bytes() const {
    return 4 * (members_.capacity() + occupied_.capacity()) + 8 * next_.capacity();
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
  void count_members(const Vectors<dim>& position, Candidates&);
  void fill_lists(const Vectors<dim>& position, Candidates&);

  std::array<double, 3> origin_{}, size_{1, 1, 1};
  std::array<std::int32_t, 3> count_{1, 1, 1};
  std::array<bool, 3> seam_{};
  std::vector<std::int32_t> members_;   // particles in each cell; then its place among those with any
  std::vector<std::int32_t> occupied_;  // cells with members
  std::vector<std::int64_t> next_;      // of each cell: present end of its list; −1: none
};

}  // namespace strake::fluid
