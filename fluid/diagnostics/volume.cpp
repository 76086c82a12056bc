#include "fluid/diagnostics/volume.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace strake::fluid {
namespace {

constexpr double cells_per_spacing = 4;
constexpr int added = 5, taken = 3;  // radii in cells: 1.25 l0 and 0.75 l0; their difference is l0/2
constexpr int border = added + taken + 1;
constexpr double most_bits = 4e10;  // 5 GB of them, one bit each

using Word = std::uint64_t;
constexpr std::int64_t bits = 64;

/// Cells in rows along x, one bit each. Rows are numbered with y running fastest.
struct Cells {
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::int64_t words = 0;  // per row
  std::vector<Word> bit;

  std::int64_t rows() const { return size[1] * size[2]; }
  std::span<Word> row(std::int64_t r) { return {bit.data() + r * words, static_cast<std::size_t>(words)}; }
  std::span<const Word> row(std::int64_t r) const {
    return {bit.data() + r * words, static_cast<std::size_t>(words)};
  }
};

/// Sets the bits [first, last].
void set(std::span<Word> row, std::int64_t first, std::int64_t last) {
  for (std::int64_t w = first / bits; w <= last / bits; ++w) {
    const std::int64_t low = std::max<std::int64_t>(first - w * bits, 0),
                       high = std::min<std::int64_t>(last - w * bits, bits - 1);
    const Word upto = high == bits - 1 ? ~Word{0} : (Word{1} << (high + 1)) - 1;
    row[static_cast<std::size_t>(w)] |= upto & ~((Word{1} << low) - 1);
  }
}

/// out ← out ∧ the cells whose `reach` neighbours on both sides along x are all set.
void keep_within(std::span<const Word> row, int reach, std::span<Word> out) {
  const std::size_t n = row.size();
  for (std::size_t w = 0; w < n; ++w) {
    const Word before = w > 0 ? row[w - 1] : 0, after = w + 1 < n ? row[w + 1] : 0, here = row[w];
    Word all = here;
    for (int k = 1; k <= reach; ++k)
      all &= ((here << k) | (before >> (bits - k))) & ((here >> k) | (after << (bits - k)));
    out[w] &= all;
  }
}

/// Returns how many cells [first, last] of a word belong to the part. A stretch without one answer is halved:
/// a rank asks once for most words, not once for each of their cells.
template <class Ask>
std::int64_t count_of_part(Word word, int first, int last, const Ask& counts) {
  const Word these = (word >> first) & (~Word{0} >> (bits - 1 - (last - first)));
  if (these == 0) return 0;
  last = first + static_cast<int>(bits) - 1 - std::countl_zero(these);
  first += std::countr_zero(these);
  if (const std::optional<bool> all = counts(first, last)) return *all ? std::popcount(these) : 0;
  const int middle = (first + last) / 2;
  return count_of_part(word, first, middle, counts) + count_of_part(word, middle + 1, last, counts);
}

/// Largest k with k² + square ≤ radius².
int half_width(int radius, int square) {
  return static_cast<int>(std::floor(std::sqrt(static_cast<double>(radius * radius - square)) + 1e-12));
}

/// Cells that are within the balls around particles, from `first` on.
template <int dim>
void cover(const Vectors<dim>& particles, double h, const Vector<dim>& low,
           const std::array<std::int64_t, 3>& first, Cells& cells) {
  // A cell counts when its middle lies within the ball. Particles of a lattice lie on corners of cells.
  const double radius = added;  // in cells
  for (Eigen::Index i = 0; i < particles.cols(); ++i) {
    const Vector<dim> x = (particles.col(i) - low) / h + Vector<dim>::Constant(border);
    const double z = dim == 3 ? x[dim - 1] : 0.5;
    const auto range = [&](double middle, double reach) {
      return std::array{static_cast<std::int64_t>(std::ceil(middle - reach - 0.5)),
                        static_cast<std::int64_t>(std::floor(middle + reach - 0.5))};
    };
    const auto deep = dim == 3 ? range(z, radius) : std::array<std::int64_t, 2>{0, 0};
    for (std::int64_t k = deep[0]; k <= deep[1]; ++k) {
      const double dz = dim == 3 ? static_cast<double>(k) + 0.5 - z : 0, rest = radius * radius - dz * dz;
      if (rest < 0) continue;
      const auto up = range(x[1], std::sqrt(rest));
      for (std::int64_t j = up[0]; j <= up[1]; ++j) {
        const double dy = static_cast<double>(j) + 0.5 - x[1], left = rest - dy * dy;
        if (left < 0) continue;
        const auto along = range(x[0], std::sqrt(left));
        if (along[0] <= along[1])
          set(cells.row((k - first[2]) * cells.size[1] + j - first[1]), along[0] - first[0],
              along[1] - first[0]);
      }
    }
  }
}

}  // namespace

template <int dim>
std::int64_t water_cells(const Vectors<dim>& particles, double spacing, const VolumePart<dim>& part) {
  if (particles.cols() == 0) return 0;
  const double h = spacing / cells_per_spacing;
  const Vector<dim> low = particles.rowwise().minCoeff(), high = particles.rowwise().maxCoeff();
  Cells cells;
  std::array<std::int64_t, 3> first{};  // the first cell here, counted from the lowest of the whole
  double count = 1;
  for (int d = 0; d < dim; ++d) {
    const auto axis = static_cast<std::size_t>(d);
    const double begin = std::floor((low[d] - part.low[d]) / h),
                 across = std::ceil((high[d] - part.low[d]) / h) - begin + 2 * border + 1;
    count *= across;
    if (!(count < most_bits)) return -1;
    first[axis] = static_cast<std::int64_t>(begin);
    cells.size[axis] = static_cast<std::int64_t>(across);
  }
  cells.words = (cells.size[0] + bits - 1) / bits;
  cells.bit.assign(static_cast<std::size_t>(cells.words * cells.rows()), 0);
  cover<dim>(particles, h, part.low, first, cells);

  const auto middle_of = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    Vector<dim> middle;
    const std::array<std::int64_t, 3> cell{x, y, z};
    for (std::size_t d = 0; d < dim; ++d)
      middle[static_cast<Eigen::Index>(d)] = part.low[static_cast<Eigen::Index>(d)] +
                                             h * (static_cast<double>(cell[d] + first[d] - border) + 0.5);
    return middle;
  };
  const int slabs = dim == 3 ? taken : 0;
  std::int64_t inside = 0;
#pragma omp parallel reduction(+ : inside)
  {
    std::vector<Word> kept(static_cast<std::size_t>(cells.words));
#pragma omp for schedule(static)
    for (std::int64_t r = 0; r < cells.rows(); ++r) {
      const std::int64_t j = r % cells.size[1], k = r / cells.size[1];
      if (j < taken || j >= cells.size[1] - taken || k < slabs || k >= cells.size[2] - slabs) continue;
      const std::span<const Word> own = cells.row(r);
      if (std::all_of(own.begin(), own.end(), [](Word w) { return w == 0; })) continue;
      std::copy(own.begin(), own.end(), kept.begin());
      for (int dz = -slabs; dz <= slabs; ++dz)
        for (int dy = -taken; dy <= taken; ++dy) {
          if (dy * dy + dz * dz > taken * taken) continue;
          keep_within(cells.row(r + dz * cells.size[1] + dy), half_width(taken, dy * dy + dz * dz), kept);
        }
      if (!part.counts)
        for (const Word w : kept) inside += std::popcount(w);
      else
        for (std::int64_t w = 0; w < cells.words; ++w)
          inside += count_of_part(kept[static_cast<std::size_t>(w)], 0, bits - 1, [&](int from, int to) {
            return part.counts(middle_of(w * bits + from, j, k), middle_of(w * bits + to, j, k));
          });
    }
  }
  return inside;
}

template <int dim>
double volume_of_cells(std::int64_t cells, double spacing) {
  if (cells < 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(cells) * std::pow(spacing / cells_per_spacing, dim);
}

template <int dim>
double water_volume(const Vectors<dim>& particles, double spacing) {
  VolumePart<dim> all;
  if (particles.cols() > 0) all.low = particles.rowwise().minCoeff();
  return volume_of_cells<dim>(water_cells<dim>(particles, spacing, all), spacing);
}

#define STRAKE_INSTANTIATE(dim)                                                                \
  template std::int64_t water_cells<dim>(const Vectors<dim>&, double, const VolumePart<dim>&); \
  template double volume_of_cells<dim>(std::int64_t, double);                                  \
  template double water_volume<dim>(const Vectors<dim>&, double);
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
