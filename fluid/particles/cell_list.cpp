#include "fluid/particles/cell_list.hpp"

#include "fluid/particles/running_sum.hpp"
#include "fluid/particles/simd_neighbours.hpp"
#include "proto/error.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace strake::fluid {
namespace {

using std::size_t;

/// Error of a distance in the screen, as a share of the radius. Lists are screened in single precision around
/// the middle of a cell. Pairs that pass the screen but are too far apart are left out of the exact rows.
constexpr double screening = 1e-5;

/// Distance from the middle of a cell [reach] above which single precision is too coarse for the screen:
/// 32 · 2⁻²⁴ = 2e-6, and a distance has up to two such errors.
constexpr double farthest = 32;

/// Cell of a particle that is absent.
constexpr std::int32_t nowhere_at_all = -1;

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
    fillers = fillers || (!tag.empty() && (tag[static_cast<size_t>(j)] & filler));
  }
  for (auto& x : screen.all)
    std::fill(x.begin() + static_cast<std::ptrdiff_t>(list.size()),
              x.begin() + static_cast<std::ptrdiff_t>(blocks * simd::wide), nowhere);
  if (fillers) {
    screen.without_fillers = screen.all;
    for (size_t k = 0; k < list.size(); ++k)
      if (tag[static_cast<size_t>(list[k])] & filler) screen.without_fillers[0][k] = nowhere;
  }
  return fillers;
}

}  // namespace

std::int64_t place_bits(Candidates& out) {
  const std::vector<std::int64_t>& start = out.list_start;
  out.bits_start.resize(out.cell.size());
  return running_sum(
      static_cast<std::int64_t>(out.cell.size()),
      [&](std::int64_t i) {
        const auto c = static_cast<size_t>(out.cell[static_cast<size_t>(i)]);
        return (start[c + 1] - start[c] + simd::wide - 1) / simd::wide;
      },
      [&](std::int64_t i, std::int64_t from, std::int64_t) {
        out.bits_start[static_cast<size_t>(i)] = from;
      });
}

void check_count(std::int64_t particles) {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  if (particles <= most) return;
  throw Error(ExitCode::case_file, "fluid.spacing",
              fmt::format("water, walls and bodies have {} particles, the fluid numbers at most {}",
                          grouped(particles), grouped(most)),
              "make fluid.spacing larger, or the tank smaller");
}

/// Finds each particle's cell and the length of each cell's list. Then next_ is where a cell's list begins,
/// and members_ the cell's number among those that have one.
template <int dim>
void CellList<dim>::count_members(const Vectors<dim>& position, std::span<const std::uint8_t> tag,
                                  Candidates& out) {
  const auto n = static_cast<std::int64_t>(position.cols());
  const std::int64_t cells = grid_.cells();
  std::vector<std::int32_t>& cell = out.cell;
  std::vector<std::int64_t>& start = out.list_start;
  cell.resize(static_cast<size_t>(n));
  members_.assign(static_cast<size_t>(cells), 0);
  next_.assign(static_cast<size_t>(cells), -1);
#pragma omp parallel
  {
    const std::int64_t team = omp_get_num_threads(), me = omp_get_thread_num();
    const std::int64_t first = n * me / team, last = n * (me + 1) / team;
    for (std::int64_t i = first; i < last; ++i)
      cell[static_cast<size_t>(i)] = !tag.empty() && (tag[static_cast<size_t>(i)] & absent)
                                         ? nowhere_at_all
                                         : grid_.cell_at(position.data() + dim * i);
    for_each_run(cell, first, last, [&](Run run) {
      std::int32_t& members = members_[static_cast<size_t>(cell[static_cast<size_t>(run.first)])];
#pragma omp atomic
      members += run.last - run.first;
      if (!any_with_row(tag, run)) return;
#pragma omp atomic write
      next_[static_cast<size_t>(cell[static_cast<size_t>(run.first)])] = 0;
    });
  }
  const auto has_list = [&](std::int64_t c) {
    return std::int64_t{next_[static_cast<size_t>(c)] < 0 ? 0 : 1};
  };
  occupied_.resize(static_cast<size_t>(std::min(n, cells)));
  const std::int64_t occupied =
      running_sum(cells, has_list, [&](std::int64_t c, std::int64_t from, std::int64_t to) {
        if (to > from) occupied_[static_cast<size_t>(from)] = static_cast<std::int32_t>(c);
      });
  occupied_.resize(static_cast<size_t>(occupied));
  start.resize(occupied_.size() + 1);
  start[0] = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t o = 0; o < occupied; ++o) {
    std::int64_t length = 0;
    grid_.around(grid_.place_of(occupied_[static_cast<size_t>(o)]),
                 [&](std::int32_t b) { length += members_[static_cast<size_t>(b)]; });
    start[static_cast<size_t>(o) + 1] = length;
  }
  running_sum(
      occupied, [&](std::int64_t o) { return start[static_cast<size_t>(o) + 1]; },
      [&](std::int64_t o, std::int64_t from, std::int64_t to) {
        start[static_cast<size_t>(o) + 1] = to;
        next_[static_cast<size_t>(occupied_[static_cast<size_t>(o)])] = from;
        members_[static_cast<size_t>(occupied_[static_cast<size_t>(o)])] = static_cast<std::int32_t>(o);
      });
}

/// Whether one of a run is not passive.
template <int dim>
bool CellList<dim>::any_with_row(std::span<const std::uint8_t> tag, Run run) {
  if (tag.empty()) return true;
  return std::any_of(tag.begin() + run.first, tag.begin() + run.last,
                     [](std::uint8_t t) { return !(t & passive); });
}

/// Calls visit(run) for the runs that the particles first ≤ i < last consist of, in their order. Particles
/// that follow one another are mostly in one cell.
template <int dim>
template <class Visit>
void CellList<dim>::for_each_run(std::span<const std::int32_t> cell, std::int64_t first, std::int64_t last,
                                 Visit&& visit) {
  for (std::int64_t i = first, end = i; i < last; i = end) {
    const std::int32_t c = cell[static_cast<size_t>(i)];
    for (++end; end < last && cell[static_cast<size_t>(end)] == c;) ++end;
    if (c == nowhere_at_all) continue;
    visit(Run{static_cast<std::int32_t>(i), static_cast<std::int32_t>(end)});
  }
}

/// Appends a run to the lists of those cells around it that are in first ≤ b < last.
template <int dim>
void CellList<dim>::append(Run run, std::int64_t first, std::int64_t last, Candidates& out) {
  grid_.around(grid_.place_of(out.cell[static_cast<size_t>(run.first)]), [&](std::int32_t b) {
    if (b < first || b >= last || next_[static_cast<size_t>(b)] < 0) return;
    std::int32_t* const to = out.lists.data() + next_[static_cast<size_t>(b)];
    for (std::int32_t k = 0; k < run.last - run.first; ++k) to[k] = run.first + k;
    next_[static_cast<size_t>(b)] += run.last - run.first;
  });
}

/// Hands a run to the owners of the lists it belongs to. Owner p has the cells from bound[p] on.
template <int dim>
void CellList<dim>::hand_out(Run run, std::span<const std::int64_t> bound, const Candidates& out,
                             std::vector<std::vector<Run>>& share) const {
  std::array<std::ptrdiff_t, 27> owners{};
  auto end = owners.begin();
  grid_.around(grid_.place_of(out.cell[static_cast<size_t>(run.first)]), [&](std::int32_t b) {
    if (next_[static_cast<size_t>(b)] < 0) return;
    const auto owner = std::upper_bound(bound.begin() + 1, bound.end() - 1, b) - bound.begin() - 1;
    if (std::find(owners.begin(), end, owner) == end) *end++ = owner;
  });
  for (auto owner = owners.begin(); owner < end; ++owner) share[static_cast<size_t>(*owner)].push_back(run);
}

/// Fills the lists of the cells. Each thread owns a range of cells with as many list entries as any other.
/// First each hands its part of the particles to the owners of the lists they belong to: the work of all
/// threads together does not grow with their number. Then it appends what it was handed, in the order of the
/// particles.
template <int dim>
void CellList<dim>::fill_lists(std::span<const std::uint8_t> tag, Candidates& out) {
  const auto n = static_cast<std::int64_t>(out.cell.size());
  const std::vector<std::int64_t>& start = out.list_start;
  make_room(out.lists, static_cast<size_t>(start.back()));
  std::vector<std::int64_t> bound;                   // first cell of each owner, and the end
  std::vector<std::vector<std::vector<Run>>> share;  // by who handed out, and to whom
#pragma omp parallel
  {
    const std::int64_t team = omp_get_num_threads(), me = omp_get_thread_num();
    const auto own = static_cast<size_t>(me);
#pragma omp single
    {
      for (std::int64_t part = 0; part < team; ++part) {
        const auto o = std::lower_bound(start.begin(), start.end() - 1, start.back() * part / team);
        bound.push_back(o == start.end() - 1 ? grid_.cells()
                                             : occupied_[static_cast<size_t>(o - start.begin())]);
      }
      bound.push_back(grid_.cells());
      share.resize(static_cast<size_t>(team));
    }
    if (team == 1) {
      for_each_run(out.cell, 0, n, [&](Run run) { append(run, 0, grid_.cells(), out); });
    } else {
      std::vector<std::vector<Run>> mine(static_cast<size_t>(team));
      for_each_run(out.cell, n * me / team, n * (me + 1) / team,
                   [&](Run run) { hand_out(run, bound, out, mine); });
      share[own] = std::move(mine);
#pragma omp barrier
      for (const auto& from : share)
        for (const Run run : from[own]) append(run, bound[own], bound[own + 1], out);
    }
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    std::int32_t& c = out.cell[static_cast<size_t>(i)];
    const bool has_row = c != nowhere_at_all && (tag.empty() || !(tag[static_cast<size_t>(i)] & passive));
    c = has_row ? members_[static_cast<size_t>(c)] : static_cast<std::int32_t>(occupied_.size());
  }
  out.list_start.push_back(out.list_start.back());
  make_room(out.bits, static_cast<size_t>(place_bits(out)));
}

template <int dim>
void CellList<dim>::find(const Vectors<dim>& position, std::span<const std::uint8_t> tag, double radius,
                         double skin, const Periodic<dim>& periodic, Candidates& out) {
  const double reach = (radius + skin) * (1 + screening);
  check_count(position.cols());
  grid_.lay(position, reach, periodic);
  count_members(position, tag, out);
  fill_lists(tag, out);
  const double low = skin + screening * radius, inside = std::max(0.0, radius - skin - screening * radius);
  Limits limits{static_cast<float>(reach * reach), static_cast<float>(low * low),
                static_cast<float>(inside * inside)};
  std::array<double, dim> inside_grid;  // of distances from the middle of a cell [m]
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<size_t>(d);
    inside_grid[k] = std::min(2 * grid_.size(d), farthest * reach);
    if (!grid_.narrow(d)) continue;
    limits.narrow = true;
    limits.period[k] = static_cast<float>(periodic.length()[d]);
    limits.inverse[k] = 1 / limits.period[k];
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
      const Vector<dim> middle = grid_.centre(grid_.place_of(occupied_[static_cast<size_t>(o)]));
      const bool fillers =
          fill_screen<dim>(position, tag, periodic, {list, length}, middle, out.cell, o, screen);
      for (const std::int32_t m : screen.member) {
        const auto k = static_cast<size_t>(m);
        const std::int32_t i = list[k];
        bool far = false;
        for (size_t d = 0; d < dim; ++d) far = far || std::abs(screen.all[d][k]) > inside_grid[d];
        const bool is_filler = fillers && (tag[static_cast<size_t>(i)] & filler);
        std::uint32_t* const bits = out.bits.data() + out.first_bits(i);
        if (far)
          take_all(k, length, bits);
        else
          screen_row<dim>(is_filler ? screen.without_fillers : screen.all, screen, k, length, limits, bits);
      }
    }
  }
}

template class CellList<2>;
template class CellList<3>;

}  // namespace strake::fluid
