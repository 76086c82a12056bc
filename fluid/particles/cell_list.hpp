#pragma once

#include "fluid/particles/cell_grid.hpp"
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
  std::vector<std::int32_t> lists;       // of the occupied cells, one behind the other
  std::vector<std::int64_t> list_start;  // of each, of an empty list, and the end
  std::vector<std::int32_t> cell;        // occupied cell of each particle
  std::vector<std::uint32_t> bits;       // sixteen partners each: low half near, high half border as well
  std::vector<std::int64_t> bits_start;  // of each particle; in 3-D 32 bits would end at 70 million particles

  std::size_t bytes() const {
    return 4 * (lists.capacity() + cell.capacity() + bits.capacity()) +
           8 * (list_start.capacity() + bits_start.capacity());
  }
  /// Returns the list to which particle i's bits refer.
  std::span<const std::int32_t> list(std::int64_t i) const {
    const auto c = static_cast<std::size_t>(cell[static_cast<std::size_t>(i)]);
    return {lists.data() + list_start[c], static_cast<std::size_t>(list_start[c + 1] - list_start[c])};
  }
  std::size_t first_bits(std::int64_t i) const {
    return static_cast<std::size_t>(bits_start[static_cast<std::size_t>(i)]);
  }
};

/// Properties of a particle for the search; one byte each, bits may be joined.
enum PairTag : std::uint8_t {
  plain = 0,
  filler = 1,   // dummy: pairs of two fillers are dropped
  asked = 2,    // pairs with at least one such particle are kept only if `keep` is true
  absent = 4,   // it has no pairs: its water is another rank's
  passive = 8,  // it has no row, but is in the rows of others: another rank computes it
};

/// Finds where the bits of each particle begin, from the lengths of the lists. Returns the number of words.
std::int64_t place_bits(Candidates&);

/// Refuses more particles than 32 bits can number. Throws Error(case_file).
void check_count(std::int64_t particles);

/// Gives each cell one list of the particles in and around it, in the order of their indices: run
/// after run of particles in one cell is appended to the lists of the cells around it. Rows that are selected
/// from such a list are sorted without sorting, and a row needs two bits per entry of the list.
template <int dim>
class CellList {
 public:
  /// Finds every pair nearer than radius + skin, except pairs of two fillers and those of absent particles
  /// (PairTag). Passive particles get no list. tag may be empty.
  void find(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double radius, double skin,
            const Periodic<dim>&, Candidates&);

  std::size_t bytes() const {
    return 4 * (members_.capacity() + occupied_.capacity()) + 8 * next_.capacity();
  }

 private:
  void count_members(const Vectors<dim>& position, std::span<const std::uint8_t> tag, Candidates&);
  void fill_lists(std::span<const std::uint8_t> tag, Candidates&);
  /// Particles first ≤ i < last of one cell.
  struct Run {
    std::int32_t first, last;
  };
  static bool any_with_row(std::span<const std::uint8_t> tag, Run);
  template <class Visit>
  static void for_each_run(std::span<const std::int32_t> cell, std::int64_t first, std::int64_t last,
                           Visit&&);
  void append(Run, std::int64_t first, std::int64_t last, Candidates&);
  void hand_out(Run, std::span<const std::int64_t> bound, const Candidates&,
                std::vector<std::vector<Run>>& share) const;

  CellGrid<dim> grid_;
  std::vector<std::int32_t> members_;   // particles in each cell; then its place among those with a list
  std::vector<std::int32_t> occupied_;  // cells with a list: with members that are not passive
  std::vector<std::int64_t> next_;      // of each cell: present end of its list; −1: none
};

}  // namespace strake::fluid
