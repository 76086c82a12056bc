#include "fluid/particles/cell_list.hpp"

#include "fluid/particles/simd_neighbours.hpp"

#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace {

using std::size_t;

/// Error of a distance in the screen, as a share of the radius. Lists are screened in single precision around
/// the middle of a cell. Pairs that pass the screen but are too far apart are left out of the exact rows.
constexpr double screening = 1e-5;

/// A coordinate far from all particles, for unused lanes of the screen.
constexpr float nowhere = 1e18F;

/// Limits of |r|² in the screen. period: of directions with less than three cells; 0: none. There the image
/// nearest to the middle of the cell is not always the one nearest to a member.
struct Limits {
  float near;         // squares below: candidates
  float low, inside;  // squares between: no border
  std::array<float, 3> period{}, inverse{};
  bool narrow = false;
};

/// Coordinates of a cell's list about its middle, one array per direction, filled up to whole lanes.
template <int dim>
struct Screen {
  std::array<std::vector<float>, dim> all, without_fillers;
  std::vector<std::int32_t> member;  // places in the list of the cell's own particles
};

/// Joins the bits of sixteen partners with those of the partners at the border, in the upper half.
std::uint32_t joined(std::uint32_t near, std::uint32_t border) {
  return border << 16 | near;
}

/// Compares member k with the whole list, sixteen partners at a time.
template <int dim>
void screen_row(const std::array<std::vector<float>, dim>& x, const Screen<dim>& screen, size_t k,
                size_t length, const Limits& limits, std::uint32_t* bits) {
  for (size_t b = 0; b < length; b += simd::wide, ++bits) {
#ifdef STRAKE_AVX512
    __m512 sum = _mm512_setzero_ps();
    for (size_t d = 0; d < dim; ++d) {
      __m512 r = _mm512_sub_ps(_mm512_loadu_ps(x[d].data() + b), _mm512_set1_ps(screen.all[d][k]));
      if (limits.narrow) {
        const __m512 periods = _mm512_roundscale_ps(_mm512_mul_ps(r, _mm512_set1_ps(limits.inverse[d])),
                                                    _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
        r = _mm512_fnmadd_ps(periods, _mm512_set1_ps(limits.period[d]), r);
      }
      sum = _mm512_fmadd_ps(r, r, sum);
    }
    const __mmask16 close = _mm512_cmp_ps_mask(sum, _mm512_set1_ps(limits.near), _CMP_LT_OQ);
    const __mmask16 sure =
        _mm512_mask_cmp_ps_mask(_mm512_cmp_ps_mask(sum, _mm512_set1_ps(limits.low), _CMP_GT_OQ), sum,
                                _mm512_set1_ps(limits.inside), _CMP_LT_OQ);
#else
    std::uint32_t close = 0, sure = 0;
    for (size_t l = 0; l < simd::wide; ++l) {
      float sum = 0;
      for (size_t d = 0; d < dim; ++d) {
        float r = x[d][b + l] - screen.all[d][k];
        if (limits.narrow) r -= limits.period[d] * std::nearbyint(limits.inverse[d] * r);
        sum += r * r;
      }
      close |= (sum < limits.near ? 1U : 0U) << l;
      sure |= (sum > limits.low && sum < limits.inside ? 1U : 0U) << l;
    }
#endif
    std::uint32_t near = close;
    if (k - b < simd::wide) near &= ~(1U << (k - b));  // itself
    *bits = joined(near, near & ~sure);
  }
}

/// Marks every partner of a particle that is too far outside the grid for a test in single precision.
void take_all(size_t k, size_t length, std::uint32_t* bits) {
  for (size_t b = 0; b < length; b += simd::wide, ++bits) {
    std::uint32_t near = simd::first_bits(static_cast<std::int64_t>(std::min<size_t>(16, length - b)));
    if (k - b < simd::wide) near &= ~(1U << (k - b));
    *bits = joined(near, near);
  }
}

/// Computes the coordinates of a cell's list about the cell's middle. Also finds the places in the list of
/// the cell's own members. Returns whether the list has fillers.
template <int dim>
bool fill_screen(const Vectors<dim>& position, std::span<const std::uint8_t> tag,
                 const Periodic<dim>& periodic, std::span<const std::int32_t> list, const Vector<dim>& middle,
                 std::span<const std::int32_t> cell_of, std::int64_t cell, Screen<dim>& screen) {
  const size_t blocks = (list.size() + simd::wide - 1) / simd::wide;
  const bool seams = periodic.any();
  bool fillers = false;
  screen.member.clear();
  for (auto& x : screen.all)
    if (x.size() < blocks * simd::wide) x.resize(blocks * simd::wide);
  for (size_t k = 0; k < list.size(); ++k) {
    const std::int32_t j = list[k];
    for (int d = 0; d < dim; ++d) {
      double x = position.data()[dim * std::int64_t{j} + d] - middle[d];
      if (seams) x = periodic.nearest(x, d);
      screen.all[static_cast<size_t>(d)][k] = static_cast<float>(x);
    }
    if (cell_of[static_cast<size_t>(j)] == cell) screen.member.push_back(static_cast<std::int32_t>(k));
    fillers = fillers || (!tag.empty() && (tag[static_cast<size_t>(j)] & 1));
  }
  for (auto& x : screen.all)
    std::fill(x.begin() + static_cast<std::ptrdiff_t>(list.size()),
              x.begin() + static_cast<std::ptrdiff_t>(blocks * simd::wide), nowhere);
  if (fillers) {
    screen.without_fillers = screen.all;
    for (size_t k = 0; k < list.size(); ++k)
      if (tag[static_cast<size_t>(list[k])] & 1) screen.without_fillers[0][k] = nowhere;
  }
  return fillers;
}

}  // namespace

template <int dim>
void CellList<dim>::lay_grid(const Vectors<dim>& position, double reach, const Periodic<dim>& periodic) {
  const auto n = position.cols();
  const double most = 4 * std::pow(static_cast<double>(n), 1.0 / dim) + 64;
  std::array<double, 3> middle{};
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const double* x = position.data() + d;
#pragma omp parallel for schedule(static) reduction(min : low) reduction(max : high)
    for (Eigen::Index i = 0; i < n; ++i) {
      low = std::min(low, x[dim * i]);
      high = std::max(high, x[dim * i]);
    }
    // The grid is around the median of a sample, so that a few far particles do not set its extent.
    constexpr Eigen::Index samples = 1001;
    std::vector<double> sample;
    for (Eigen::Index i = 0; i < n; i += std::max<Eigen::Index>(1, n / samples)) sample.push_back(x[dim * i]);
    const auto median = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
    std::nth_element(sample.begin(), median, sample.end());
    middle[k] = sample.empty() ? 0 : *median;
    seam_[k] = periodic.along(d);
    if (seam_[k]) {
      origin_[k] = low;
      count_[k] = static_cast<std::int32_t>(std::min(most, periodic.length()[d] / reach));
      size_[k] = periodic.length()[d] / count_[k];
    } else {
      origin_[k] = sample.empty() ? 0 : std::max(low, middle[k] - 0.5 * most * reach);
      const double extent = sample.empty() ? 0 : std::min(high - origin_[k], most * reach);
      count_[k] = static_cast<std::int32_t>(extent / reach) + 1;
      size_[k] = reach;
    }
  }
  // The number of cells is limited to a few per particle: the longest extent around the median is halved.
  const auto cells = [&] { return std::int64_t{count_[0]} * count_[1] * count_[2]; };
  while (cells() > 16 * n + 65536) {
    size_t longest = 3;
    for (size_t k = 0; k < dim; ++k)
      if (!seam_[k] && (longest == 3 || count_[k] > count_[longest])) longest = k;
    if (longest == 3) break;  // periodic in all directions: the extents are those of the case
    count_[longest] = (count_[longest] + 1) / 2;
    origin_[longest] = std::clamp(middle[longest] - 0.5 * count_[longest] * size_[longest], origin_[longest],
                                  origin_[longest] + count_[longest] * size_[longest]);
  }
}

template <int dim>
CellList<dim>::Place CellList<dim>::place(const double* x) const {
  Place p{};
  for (size_t d = 0; d < dim; ++d) {
    double at = (x[d] - origin_[d]) / size_[d];
    if (seam_[d]) {
      if (at < 0) at += count_[d];
      if (at >= count_[d]) at -= count_[d];
    }
    p[d] = static_cast<std::int32_t>(std::clamp(at, 0.0, static_cast<double>(count_[d] - 1)));
  }
  return p;
}

template <int dim>
CellList<dim>::Place CellList<dim>::place_of(std::int32_t cell) const {
  return {cell % count_[0], cell / count_[0] % count_[1], cell / (count_[0] * count_[1])};
}

template <int dim>
Vector<dim> CellList<dim>::centre(const Place& p) const {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    x[d] = origin_[k] + (p[k] + 0.5) * size_[k];
  }
  return x;
}

/// Calls body(cell) for a cell and all that touch it, each once.
template <int dim>
template <class Body>
void CellList<dim>::around(const Place& p, Body&& body) const {
  std::array<std::array<std::int32_t, 3>, 3> along{};
  std::array<int, 3> found{1, 1, 1};
  for (size_t d = 0; d < dim; ++d) {
    found[d] = 0;
    for (int step = -1; step <= 1; ++step) {
      std::int32_t k = p[d] + step;
      if (seam_[d]) {
        if ((step == 1 && count_[d] <= 2) || (step == -1 && count_[d] == 1)) continue;  // the same cell again
        k = (k + count_[d]) % count_[d];
      } else if (k < 0 || k >= count_[d]) {
        continue;
      }
      along[d][static_cast<size_t>(found[d]++)] = k;
    }
  }
  for (int z = 0; z < found[2]; ++z)
    for (int y = 0; y < found[1]; ++y)
      for (int x = 0; x < found[0]; ++x)
        body(number({along[0][static_cast<size_t>(x)], along[1][static_cast<size_t>(y)],
                     along[2][static_cast<size_t>(z)]}));
}

/// Finds each particle's cell and the length of each cell's list. Then next_ is where a cell's list begins,
/// and members_ the cell's number among those that are occupied.
template <int dim>
void CellList<dim>::count_members(const Vectors<dim>& position, Candidates& out) {
  const auto n = static_cast<std::int64_t>(position.cols());
  const std::int64_t cells = std::int64_t{count_[0]} * count_[1] * count_[2];
  std::vector<std::int32_t>& cell = out.cell;
  std::vector<std::int64_t>& start = out.list_start;
  cell.resize(static_cast<size_t>(n));
  members_.assign(static_cast<size_t>(cells), 0);
  next_.assign(static_cast<size_t>(cells), -1);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i)
    cell[static_cast<size_t>(i)] = number(place(position.data() + dim * i));
  for (const std::int32_t c : cell) ++members_[static_cast<size_t>(c)];
  occupied_.clear();
  for (std::int64_t c = 0; c < cells; ++c)
    if (members_[static_cast<size_t>(c)]) occupied_.push_back(static_cast<std::int32_t>(c));
  const auto occupied = static_cast<std::int64_t>(occupied_.size());
  start.resize(occupied_.size() + 1);
  start[0] = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t o = 0; o < occupied; ++o) {
    std::int64_t length = 0;
    around(place_of(occupied_[static_cast<size_t>(o)]),
           [&](std::int32_t b) { length += members_[static_cast<size_t>(b)]; });
    start[static_cast<size_t>(o) + 1] = length;
  }
  for (size_t o = 0; o < occupied_.size(); ++o) {
    start[o + 1] += start[o];
    next_[static_cast<size_t>(occupied_[o])] = start[o];
    members_[static_cast<size_t>(occupied_[o])] = static_cast<std::int32_t>(o);
  }
}

/// Fills the lists of the cells. Each thread owns a range of cells, and appends to their lists.
template <int dim>
void CellList<dim>::fill_lists(const Vectors<dim>& position, Candidates& out) {
  count_members(position, out);
  const auto n = static_cast<std::int64_t>(position.cols());
  const std::int64_t cells = std::int64_t{count_[0]} * count_[1] * count_[2];
  const auto occupied = static_cast<std::int64_t>(occupied_.size());
  std::vector<std::int32_t>& cell = out.cell;
  const std::vector<std::int64_t>& start = out.list_start;
  make_room(out.lists, static_cast<size_t>(start.back()));
#pragma omp parallel
  {
    // Each thread gets as many list entries.
    const auto share = [&](std::int64_t part) {
      const std::int64_t entry = start.back() * part / omp_get_num_threads();
      const auto o = std::lower_bound(start.begin(), start.end(), entry) - start.begin();
      return o < occupied ? std::int64_t{occupied_[static_cast<size_t>(o)]} : cells;
    };
    const std::int64_t first = share(omp_get_thread_num()), last = share(omp_get_thread_num() + 1);
    std::array<std::int64_t*, 27> ends{};
    size_t n_lists = 0;
    std::int32_t of = -1;
    for (std::int64_t i = 0; i < n; ++i) {
      const std::int32_t c = cell[static_cast<size_t>(i)];
      if (c != of) {  // mostly the one before
        of = c;
        n_lists = 0;
        around(place_of(c), [&](std::int32_t b) {
          if (b >= first && b < last && next_[static_cast<size_t>(b)] >= 0)
            ends[n_lists++] = &next_[static_cast<size_t>(b)];
        });
      }
      for (size_t l = 0; l < n_lists; ++l)
        out.lists[static_cast<size_t>((*ends[l])++)] = static_cast<std::int32_t>(i);
    }
  }
  out.bits_start.resize(static_cast<size_t>(n));
  std::int64_t words = 0;
  for (std::int64_t i = 0; i < n; ++i) {
    std::int32_t& c = cell[static_cast<size_t>(i)];
    c = members_[static_cast<size_t>(c)];
    out.bits_start[static_cast<size_t>(i)] = static_cast<std::uint32_t>(words);
    words +=
        (start[static_cast<size_t>(c) + 1] - start[static_cast<size_t>(c)] + simd::wide - 1) / simd::wide;
  }
  make_room(out.bits, static_cast<size_t>(words));
}

template <int dim>
void CellList<dim>::find(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double radius,
                         double skin, const Periodic<dim>& periodic, Candidates& out) {
  const double reach = (radius + skin) * (1 + screening);
  lay_grid(position, reach, periodic);
  fill_lists(position, out);
  const double low = skin + screening * radius, inside = std::max(0.0, radius - skin - screening * radius);
  Limits limits{static_cast<float>(reach * reach), static_cast<float>(low * low),
                static_cast<float>(inside * inside)};
  for (size_t d = 0; d < dim; ++d) {
    if (!seam_[d] || count_[d] >= 3) continue;
    limits.narrow = true;
    limits.period[d] = static_cast<float>(periodic.length()[static_cast<int>(d)]);
    limits.inverse[d] = 1 / limits.period[d];
  }
  const auto occupied = static_cast<std::int64_t>(occupied_.size());
#pragma omp parallel
  {
    Screen<dim> screen;
#pragma omp for schedule(dynamic, 16)
    for (std::int64_t o = 0; o < occupied; ++o) {
      const std::int32_t* list = out.lists.data() + out.list_start[static_cast<size_t>(o)];
      const auto length = static_cast<size_t>(out.list_start[static_cast<size_t>(o) + 1] -
                                              out.list_start[static_cast<size_t>(o)]);
      const Vector<dim> middle = centre(place_of(occupied_[static_cast<size_t>(o)]));
      const bool fillers =
          fill_screen<dim>(position, tag, periodic, {list, length}, middle, out.cell, o, screen);
      for (const std::int32_t m : screen.member) {
        const auto k = static_cast<size_t>(m);
        const std::int32_t i = list[k];
        bool far = false;
        for (size_t d = 0; d < dim; ++d) far = far || std::abs(screen.all[d][k]) > 2 * size_[d];
        const bool filler = fillers && (tag[static_cast<size_t>(i)] & 1);
        std::uint32_t* const bits = out.bits.data() + out.first_bits(i);
        if (far)
          take_all(k, length, bits);
        else
          screen_row<dim>(filler ? screen.without_fillers : screen.all, screen, k, length, limits, bits);
      }
    }
  }
}

template class CellList<2>;
template class CellList<3>;

}  // namespace strake::fluid
