#include "fluid/diagnostics/voids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace strake::fluid {
namespace {

/// Reach from a surface particle within which there is outer air. The middle of the nearest cell of air is at
/// most 2.5 l0 away along an axis, because cells next to a particle are covered. A void is 5 l0 deeper.
constexpr std::int64_t reach = 7;   // [l0], and cells
constexpr double most_cells = 2e9;  // bytes

enum Cell : std::uint8_t { empty, covered, air };

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

  /// Marks the cells at particles as covered. Returns false if there are too many cells.
  bool cover() {
    double count = 1;
    for (int d = 0; d < dim; ++d) {
      const double across = std::floor((high_[d] - low_[d]) / spacing_) + (d == 1 ? 4 : 1);  // room above
      count *= across;
      if (!(count < most_cells)) return false;
      size_[static_cast<std::size_t>(d)] = static_cast<std::int64_t>(across);
    }
    stride_ = {1, size_[0], size_[0] * size_[1]};
    cell_.assign(static_cast<std::size_t>(count), empty);
    for (const std::int64_t i : particles_) {
      const auto at = cell_of(i);
      around(at, 1, [&](std::size_t k) { cell_[k] = covered; });
    }
    return true;
  }

  /// Marks as air all cells that are connected with the cells above all particles.
  void fill_from_above() {
    for (std::int64_t z = 0; z < size_[2]; ++z)
      for (std::int64_t x = 0; x < size_[0]; ++x) fill(index({x, size_[1] - 1, z}), air);
  }
  /// Marks the largest of all connected spaces as air.
  void fill_largest() {
    constexpr std::uint8_t seen = air + 1;
    std::size_t most = 0, seed = cell_.size();
    for (std::size_t k = 0; k < cell_.size(); ++k) {
      const std::size_t count = fill(k, seen);
      if (count <= most) continue;
      most = count;
      seed = k;
    }
    for (std::uint8_t& cell : cell_)
      if (cell == seen) cell = empty;
    if (seed < cell_.size()) fill(seed, air);
  }

  bool near_air(std::int64_t particle) const {
    bool found = false;
    around(cell_of(particle), reach, [&](std::size_t k) { found = found || cell_[k] == air; });
    return found;
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  std::size_t index(const Place& p) const {
    return static_cast<std::size_t>(p[0] * stride_[0] + p[1] * stride_[1] + p[2] * stride_[2]);
  }
  Place cell_of(std::int64_t i) const {
    Place place{};
    for (int d = 0; d < dim; ++d)
      place[static_cast<std::size_t>(d)] =
          static_cast<std::int64_t>((state_.position(d, i) - low_[d]) / spacing_);
    return place;
  }
  template <class Visit>
  void around(const Place& at, std::int64_t width, Visit&& visit) const {
    const auto from = [&](std::size_t d) { return std::max<std::int64_t>(at[d] - width, 0); };
    const auto to = [&](std::size_t d) { return std::min(at[d] + width, size_[d] - 1); };
    for (std::int64_t z = from(2); z <= to(2); ++z)
      for (std::int64_t y = from(1); y <= to(1); ++y)
        for (std::int64_t x = from(0); x <= to(0); ++x) visit(index({x, y, z}));
  }
  /// Gives that value to all empty cells connected with k. Returns their number.
  std::size_t fill(std::size_t k, std::uint8_t value) {
    if (cell_[k] != empty) return 0;
    std::size_t count = 0;
    open_.assign(1, k);
    cell_[k] = value;
    while (!open_.empty()) {
      const std::size_t here = open_.back();
      open_.pop_back();
      ++count;
      const auto number = static_cast<std::int64_t>(here);
      for (std::size_t d = 0; d < dim; ++d) {
        const std::int64_t place = number / stride_[d] % size_[d];
        for (const std::int64_t step : {-1, 1}) {
          if (place + step < 0 || place + step >= size_[d]) continue;
          const auto next = static_cast<std::size_t>(number + step * stride_[d]);
          if (cell_[next] != empty) continue;
          cell_[next] = value;
          open_.push_back(next);
        }
      }
    }
    return count;
  }

  const State<dim>& state_;
  double spacing_;
  std::vector<std::int64_t> particles_;
  Vector<dim> low_, high_;
  std::array<std::int64_t, 3> size_{1, 1, 1}, stride_{1, 1, 1};
  std::vector<std::uint8_t> cell_;
  std::vector<std::size_t> open_;
};

}  // namespace

template <int dim>
Voids count_voids(const State<dim>& state, std::span<const std::int64_t> water, double spacing,
                  bool open_top) {
  Voids voids;
  if (water.empty()) return voids;
  Grid<dim> grid(state, water, spacing);
  if (!grid.cover()) return voids;
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

#define STRAKE_INSTANTIATE(dim)                                                                    \
  template Voids count_voids<dim>(const State<dim>&, std::span<const std::int64_t>, double, bool); \
  template void follow_air<dim>(State<dim>&, const Neighbours&, std::int64_t, std::vector<std::uint8_t>&);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
