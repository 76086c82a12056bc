#pragma once

#include "fluid/particles/periodic.hpp"
#include "fluid/particles/state.hpp"

#include <array>
#include <cstdint>

namespace strake::fluid {

/// Returns the largest number of cells for n particles: 16 n + 65536, and no more than 32 bits can number.
std::int64_t most_cells(std::int64_t n);

/// Divides space into cells no smaller than a reach. All partners of a particle are then in its own or an
/// adjacent cell. The cells cover all particles, unless that takes more than `most_cells`. Then the direction
/// whose extent exceeds most that of the bulk of the particles is halved, and again. So the bulk stays
/// inside, however long its shape is, and a far particle costs no memory.
///
/// Particles outside the grid belong to its edge cells. Clamping two cell numbers never moves them apart, so
/// the search stays right.
template <int dim>
class CellGrid {
 public:
  using Place = std::array<std::int32_t, 3>;
  void lay(const Vectors<dim>& position, double reach, const Periodic<dim>&);

  std::int64_t cells() const { return std::int64_t{count_[0]} * count_[1] * count_[2]; }
  std::int32_t cell_at(const double* x) const { return number(place(x)); }
  Place place_of(std::int32_t cell) const {
    return {cell % count_[0], cell / count_[0] % count_[1], cell / (count_[0] * count_[1])};
  }
  Vector<dim> centre(const Place&) const;
  double size(int direction) const { return size_[static_cast<std::size_t>(direction)]; }  // of a cell [m]
  /// Whether a periodic direction has less than three cells. There the image nearest to the middle of a cell
  /// is not always the one nearest to a member of it.
  bool narrow(int direction) const {
    return seam_[static_cast<std::size_t>(direction)] && count_[static_cast<std::size_t>(direction)] < 3;
  }
  /// Calls body(cell) for a cell and all that touch it, each once.
  template <class Body>
  void around(const Place&, Body&&) const;

 private:
  /// Extent of the particles along one direction [m]. bulk: between the tenth and the nine tenths of them.
  struct Extent {
    double low = 0, high = 0, median = 0, bulk = 0;
  };
  static Extent extent(const Vectors<dim>& position, int direction);
  Place place(const double* x) const;
  std::int32_t number(const Place& p) const { return (p[2] * count_[1] + p[1]) * count_[0] + p[0]; }

  std::array<double, 3> origin_{}, size_{1, 1, 1};
  std::array<std::int32_t, 3> count_{1, 1, 1};
  std::array<bool, 3> seam_{};
};

template <int dim>
template <class Body>
void CellGrid<dim>::around(const Place& p, Body&& body) const {
  std::array<std::array<std::int32_t, 3>, 3> along{};
  std::array<int, 3> found{1, 1, 1};
  for (std::size_t d = 0; d < dim; ++d) {
    found[d] = 0;
    for (int step = -1; step <= 1; ++step) {
      std::int32_t k = p[d] + step;
      if (seam_[d]) {
        if ((step == 1 && count_[d] <= 2) || (step == -1 && count_[d] == 1)) continue;  // the same cell again
        k = (k + count_[d]) % count_[d];
      } else if (k < 0 || k >= count_[d]) {
        continue;
      }
      along[d][static_cast<std::size_t>(found[d]++)] = k;
    }
  }
  for (int z = 0; z < found[2]; ++z)
    for (int y = 0; y < found[1]; ++y)
      for (int x = 0; x < found[0]; ++x)
        body(number({along[0][static_cast<std::size_t>(x)], along[1][static_cast<std::size_t>(y)],
                     along[2][static_cast<std::size_t>(z)]}));
}

}  // namespace strake::fluid
