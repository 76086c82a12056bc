#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/pressure_solver/coarse_level.hpp"
#include "fluid/pressure_solver/pressure_system.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace strake::fluid {

template <int dim>
struct RankedUnknowns;

/// Returns the weights of the corners of a cell for a place in it. f: the place, from 0 to 1 along each axis.
template <int dim>
inline std::array<float, std::size_t{1} << dim> corner_weights(const std::array<float, dim>& f) {
  std::array<float, std::size_t{1} << dim> w;
  w[0] = 1;
  for (std::size_t d = 0; d < dim; ++d) {
    const std::size_t half = std::size_t{1} << d;
    for (std::size_t a = 0; a < half; ++a) {
      w[a + half] = w[a] * f[d];
      w[a] -= w[a + half];
    }
  }
  return w;
}

/// Sorts the unknowns of a pressure equation into square cells as large as the Laplacian's reach. Rows then
/// reach no further than the adjacent cells. A piece is a set of unknowns of one cell that are connected;
/// water on both sides of a plate in one cell makes two. The vertices of the cells carry the coarse unknowns.
/// A vertex has one for each connected set of the pieces around it.
template <int dim>
class Aggregates {
 public:
  static constexpr int corners = 1 << dim;  // of a cell; bit d of a corner's number: upper along axis d
  static constexpr int around = dim == 2 ? 9 : 27;  // a cell and those adjacent to it
  static constexpr int middle = (around - 1) / 2;

  /// Sorts the unknowns into cells of `cell_size` [m]. A cell is sparse with less than half of `full`
  /// unknowns.
  void sort(const PressureSystem&, const Vectors<dim>& position, double cell_size, double full);
  /// The same of one rank: own unknowns and the copies around them, into their buckets.
  void sort(const RankedUnknowns<dim>&, double full);
  /// Whether the cell of an unknown is sparse, and whether that or an adjacent one is.
  bool is_sparse(std::int64_t unknown) const { return density(unknown) > 1; }
  bool is_near_sparse(std::int64_t unknown) const { return density(unknown) > 0; }
  /// Cells around an unknown that its row touches, one bit each. own_cell_entries: number of entries in its
  /// own cell. Both are filled after `sort`, by the function that reads the matrix.
  std::vector<std::uint32_t> touched;
  std::vector<std::int32_t> own_cell_entries;
  /// Divides the cells into pieces, and makes the coarse unknowns: `level.place`, `.first`, `.size`.
  void split(const PressureSystem&, CoarseLevel<dim>& level);

  std::int32_t pieces() const { return static_cast<std::int32_t>(piece_start.size()) - 1; }
  /// Number of unknowns, with the copies of others; on several ranks not all of them are in pieces.
  std::int64_t unknowns() const { return static_cast<std::int64_t>(cell_.size()); }
  /// Whether this rank owns the piece.
  bool owns(std::int32_t piece) const {
    return piece_owner_.empty() || piece_owner_[static_cast<std::size_t>(piece)] == rank_;
  }
  std::size_t bytes() const;

  /// Place of each unknown from the grid's corner, per axis [cells].
  std::array<std::vector<float>, dim> at;
  std::vector<std::int32_t> order;                   // unknowns piece by piece
  std::vector<std::int32_t> piece_start;             // in order, and one more
  std::vector<std::int32_t> node;                    // coarse unknown of each corner of each piece
  std::vector<std::int32_t> piece_of;                // of each unknown
  std::vector<std::int32_t> meeting_start, meeting;  // per coarse unknown: the piece corners that meet in it
  /// On several ranks: the owner of each coarse unknown. There, only those of own pieces have a number.
  std::vector<int> node_owner;

 private:
  using Link = std::pair<std::int32_t, std::int32_t>;
  std::int64_t cell_of(std::int64_t unknown) const;
  /// From a cell to the one around it with that number.
  std::int64_t step_to(int near) const {
    return (near / 9 - (dim == 3 ? 1 : 0)) * static_cast<std::int64_t>(count_[1]) * count_[0] +
           (near / 3 % 3 - 1) * static_cast<std::int64_t>(count_[0]) + near % 3 - 1;
  }
  std::uint8_t density(std::int64_t unknown) const {
    return density_[static_cast<std::size_t>(cell_[static_cast<std::size_t>(unknown)])];
  }
  void sort_by_cell(std::span<const std::int32_t> sorted, double full);
  void find_sparse(double full);
  void split_cells(const PressureSystem&);
  bool is_own_cell(std::int64_t begin) const {
    return ranked_->owner[static_cast<std::size_t>(order[static_cast<std::size_t>(begin)])] == rank_;
  }
  void share_parts(const PressureSystem&);
  void start_parts(std::int64_t begin, std::int64_t end);
  bool is_whole(std::int64_t begin, std::int64_t end) const;
  void find_parts(const PressureSystem&, std::int64_t begin, std::int64_t end);
  void link_pieces(const PressureSystem&);
  std::vector<std::uint8_t> pieces_to_link() const;
  void share_links();
  /// A piece at a vertex. corner: which corner of the piece's cell the vertex is. part: the connected set of
  /// the piece; −1: none.
  struct Member {
    std::int32_t piece;
    int corner, part;
  };
  void gather_vertices(CoarseLevel<dim>& level);
  /// Numbers the connected sets of the pieces around one vertex; returns how many there are.
  int join_members(std::vector<Member>&) const;
  bool begin_node(const std::vector<Member>&, int part);
  bool linked(std::int32_t p, std::int32_t q, int direction) const;

  std::array<std::int32_t, 3> count_{1, 1, 1};   // cells per axis, with an empty ring around
  std::vector<std::int32_t> cell_, cell_start_;  // of each unknown; unknowns of each cell in order
  std::vector<std::int32_t> first_piece_;        // of each cell, and one more
  std::vector<std::uint32_t> piece_touches_;     // bits as `touched`, of all unknowns of the piece
  std::vector<std::uint8_t> shared_cell_;        // of each piece: its cell has another one
  std::vector<std::uint8_t> density_;            // of each cell: 2 sparse, 1 beside such a one, 0 neither
  std::vector<Link> links_;                      // between pieces of which one shares its cell, sorted
  const RankedUnknowns<dim>* ranked_ = nullptr;  // of the last sort; null: one rank
  int rank_ = 0;
  std::vector<int> piece_owner_;    // on several ranks
  std::vector<std::int32_t> part_;  // on several ranks: of each unknown, the number of its part in the cell
};

}  // namespace strake::fluid
