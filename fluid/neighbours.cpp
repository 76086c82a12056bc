#include "fluid/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>

#include "proto/error.hpp"

namespace strake::fluid {
namespace {

using std::size_t;

/// Square of |x_j − x_i| [m²]. This file is compiled without contraction to fused operations, so that i-j and
/// j-i give the same bits.
template <int dim>
inline double squared_distance(const double* a, const double* b, const Periodic<dim>& periodic) {
  double sum = 0;
  for (int d = 0; d < dim; ++d) {
    const double r = periodic.nearest(b[d] - a[d], d);
    sum += r * r;
  }
  return sum;
}

/// Two particles nearer than this share of the radius have no direction between them: they do not see one
/// another.
constexpr double coincident = 1e-9;

/// Loops that select work on so many pairs at a time.
constexpr size_t chunk = 64;

/// Numbers of particles, `used` of them, with room at the end to write before it is known whether to keep.
struct Buffer {
  std::vector<std::int32_t> value;
  size_t used = 0;
};

/// The places of the values below `limit` among n <= chunk of them, and how many.
inline size_t select_below(const double* value, double limit, size_t n,
                           std::array<std::uint8_t, chunk>& selected) {
  size_t used = 0;
  for (size_t k = 0; k < n; ++k) {
    selected[used] = static_cast<std::uint8_t>(k);
    used += value[k] < limit ? 1 : 0;
  }
  return used;
}

/// Cells no smaller than the search radius, so that all partners of a particle are in its own or an adjacent
/// cell. Particles outside the grid belong to its edge cells: clamping two cell numbers never moves them
/// apart, so the search stays right and a far flyer costs time, never memory.
template <int dim>
class CellGrid {
 public:
  CellGrid(const Vectors<dim>& position, double size) : size_(size) {
    const auto n = position.cols();
    const auto max_cells = static_cast<std::int64_t>(4 * std::pow(static_cast<double>(n), 1.0 / dim)) + 64;
    // Around the median, so that a few far flyers do not set the extent.
    std::vector<double> coordinate(static_cast<size_t>(n));
    for (int d = 0; d < dim; ++d) {
      for (Eigen::Index i = 0; i < n; ++i) coordinate[static_cast<size_t>(i)] = position(d, i);
      const auto [low, high] = std::minmax_element(coordinate.begin(), coordinate.end());
      const double lowest = *low, highest = *high;
      std::nth_element(coordinate.begin(), coordinate.begin() + n / 2, coordinate.end());
      const double reach = 0.5 * static_cast<double>(max_cells) * size_;
      const auto k = static_cast<size_t>(d);
      origin_[k] = std::max(lowest, coordinate[static_cast<size_t>(n / 2)] - reach);
      const double extent = std::min(highest - origin_[k], 2 * reach);
      count_[k] = static_cast<std::int64_t>(extent / size_) + 1;
    }
    std::int64_t cells = 1;
    for (int d = 0; d < dim; ++d) cells *= count_[static_cast<size_t>(d)];
    start_.assign(static_cast<size_t>(cells) + 1, 0);
    std::vector<std::int32_t> cell(static_cast<size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto c = index(place(position.col(i).data()));
      cell[static_cast<size_t>(i)] = static_cast<std::int32_t>(c);
      ++start_[static_cast<size_t>(c) + 1];
    }
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    particle_.resize(static_cast<size_t>(n));
    for (auto& coordinates : sorted_) coordinates.resize(static_cast<size_t>(n));
    std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto slot = next[static_cast<size_t>(cell[static_cast<size_t>(i)])]++;
      particle_[static_cast<size_t>(slot)] = static_cast<std::int32_t>(i);
      for (int d = 0; d < dim; ++d)
        sorted_[static_cast<size_t>(d)][static_cast<size_t>(slot)] = position(d, i);
    }
  }

  /// Appends every particle within `radius` of `at` [m] to `found`, in the cells' order, itself included.
  void append_within(const double* at, double radius, Buffer& found) const {
    const auto centre = place(at);
    const double squared = radius * radius;
    std::array<std::int64_t, 3> low{}, high{};
    for (size_t d = 0; d < static_cast<size_t>(dim); ++d) {
      low[d] = std::max<std::int64_t>(centre[d] - 1, 0);
      high[d] = std::min(centre[d] + 1, count_[d] - 1);
    }
    for (auto z = low[2]; z <= high[2]; ++z)
      for (auto y = low[1]; y <= high[1]; ++y) {
        // Cells adjacent in x are adjacent in memory: one run of particles.
        const auto first = static_cast<size_t>(start_[static_cast<size_t>(index({low[0], y, z}))]);
        const auto last = static_cast<size_t>(start_[static_cast<size_t>(index({high[0], y, z})) + 1]);
        for (auto k = first; k < last; k += chunk)
          append_chunk(at, squared, k, std::min(chunk, last - k), found);
      }
  }

 private:
  // Distances first, in a loop without branches; then the selection, also without.
  void append_chunk(const double* at, double squared, size_t first, size_t n, Buffer& found) const {
    std::array<double, chunk> square{};
    for (size_t d = 0; d < static_cast<size_t>(dim); ++d) {
      const double *x = sorted_[d].data() + first, centre = at[d];
      for (size_t k = 0; k < n; ++k) square[k] += (x[k] - centre) * (x[k] - centre);
    }
    if (found.value.size() < found.used + n) found.value.resize(2 * (found.used + chunk));
    std::int32_t* out = found.value.data();
    auto used = found.used;
    for (size_t k = 0; k < n; ++k) {
      out[used] = particle_[first + k];
      used += square[k] < squared ? 1 : 0;
    }
    found.used = used;
  }
  using Place = std::array<std::int64_t, 3>;
  Place place(const double* x) const {
    Place p{};
    for (size_t d = 0; d < static_cast<size_t>(dim); ++d) {
      const double cell = std::clamp((x[d] - origin_[d]) / size_, 0.0, static_cast<double>(count_[d] - 1));
      p[d] = static_cast<std::int64_t>(cell);
    }
    return p;
  }
  std::int64_t index(const Place& p) const { return (p[2] * count_[1] + p[1]) * count_[0] + p[0]; }

  double size_;
  std::array<double, 3> origin_{};
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<std::int32_t> start_, particle_;
  std::array<std::vector<double>, static_cast<size_t>(dim)> sorted_;  // coordinates in the cells' order [m]
};

template <int dim>
void require_finite(const Vectors<dim>& position) {
  for (Eigen::Index i = 0; i < position.cols(); ++i)
    if (!position.col(i).array().isFinite().all())
      throw Error(
          ExitCode::solver_fault, "fluid", fmt::format("the position of particle {} is not finite", i),
          "lower fluid.scheme.time_step or fluid.scheme.cfl; look at the last frames for where it began");
}

void drop_filler_pairs(std::span<const std::uint8_t> tag, std::vector<std::int64_t>& start,
                       std::vector<std::int32_t>& column) {
  size_t kept = 0;
  auto first = start[0];
  for (size_t i = 0; i + 1 < start.size(); ++i) {
    const auto last = start[i + 1];
    for (auto c = first; c < last; ++c) {
      const auto j = column[static_cast<size_t>(c)];
      if (!(tag[i] & tag[static_cast<size_t>(j)] & filler)) column[kept++] = j;
    }
    first = last;
    start[i + 1] = static_cast<std::int64_t>(kept);
  }
  column.resize(kept);
}

}  // namespace

template <int dim>
NeighbourSearch<dim>::NeighbourSearch(double radius, double skin, const Periodic<dim>& periodic)
    : radius_(radius), skin_(skin), periodic_(periodic) {
  assert(radius > 0 && skin >= 0);
  for (int d = 0; d < dim; ++d)
    if (const double length = periodic.length()[d], least = 2 * (radius + skin);
        length > 0 && !(length >= least))
      throw Error(
          ExitCode::case_file, "fluid.periodic",
          fmt::format("the period of {:.6g} m along {} is shorter than twice the search radius, {:.6g} m",
                      length, "xyz"[d], least),
          "make fluid.tank larger along it, or fluid.spacing smaller");
}

template <int dim>
void NeighbourSearch<dim>::invalidate() {
  valid_ = false;
  for (auto& part : parts_) part.fresh = false;
}

template <int dim>
void NeighbourSearch<dim>::rebuild(const Vectors<dim>& position, std::span<const std::uint8_t> tag) {
  require_finite<dim>(position);
  const auto n = position.cols();
  const double reach = radius_ + skin_;
  const CellGrid<dim> grid(position, reach);
  if (periodic_.any()) {
    // Over each seam once more: at most one image of a partner is in reach.
    candidate_.clear();
    candidate_start_.assign(1, 0);
    Buffer mine;
    const Vector<dim> length = periodic_.length();
    for (Eigen::Index i = 0; i < n; ++i) {
      mine.used = 0;
      for (int image = 0; image < (dim == 2 ? 9 : 27); ++image) {
        const std::array<int, 3> over{image % 3 - 1, image / 3 % 3 - 1, dim == 2 ? 0 : image / 9 - 1};
        Vector<dim> at = position.col(i);
        bool exists = true;
        for (int d = 0; d < dim; ++d) {
          const int count = over[static_cast<size_t>(d)];
          exists = exists && (count == 0 || periodic_.along(d));
          at[d] += count * length[d];
        }
        if (exists) grid.append_within(at.data(), reach * (1 + 1e-9), mine);
      }
      const auto begin = mine.value.begin(), end = begin + static_cast<std::ptrdiff_t>(mine.used);
      std::sort(begin, end);
      std::copy_if(begin, end, std::back_inserter(candidate_), [i](std::int32_t j) { return j != i; });
      candidate_start_.push_back(static_cast<std::int64_t>(candidate_.size()));
    }
    if (!tag.empty()) drop_filler_pairs(tag, candidate_start_, candidate_);
    candidate_squared_.resize(candidate_.size());
    built_at_ = position;
    built_tag_.assign(tag.begin(), tag.end());
    valid_ = true;
    ++rebuilds_;
    return;
  }
  // First each particle's partners in the cells' order, in blocks of particles; then the transpose, whose
  // rows come out sorted because the relation is symmetric.
  constexpr Eigen::Index block = 1024;
  const auto n_blocks = (n + block - 1) / block;
  std::vector<Buffer> found(static_cast<size_t>(n_blocks));
  std::vector<std::int32_t> count(static_cast<size_t>(n));  // with the particle itself
#pragma omp parallel for schedule(static)
  for (Eigen::Index b = 0; b < n_blocks; ++b) {
    auto& mine = found[static_cast<size_t>(b)];
    for (auto i = b * block; i < std::min(n, (b + 1) * block); ++i) {
      const auto before = mine.used;
      grid.append_within(position.col(i).data(), reach, mine);
      count[static_cast<size_t>(i)] = static_cast<std::int32_t>(mine.used - before);
    }
  }
  candidate_start_.resize(static_cast<size_t>(n) + 1);
  candidate_start_[0] = 0;
  for (size_t i = 0; i < count.size(); ++i) candidate_start_[i + 1] = candidate_start_[i] + count[i] - 1;
  const auto pairs = static_cast<size_t>(candidate_start_.back());
  candidate_.resize(pairs);
  std::vector<std::int64_t> next(candidate_start_.begin(), candidate_start_.end() - 1);
  Eigen::Index i = 0;
  for (const auto& mine : found) {
    size_t k = 0;
    for (const auto end = std::min(n, i + block); i < end; ++i)
      for (std::int32_t c = 0; c < count[static_cast<size_t>(i)]; ++c, ++k) {
        const auto j = mine.value[k];
        if (j != i)
          candidate_[static_cast<size_t>(next[static_cast<size_t>(j)]++)] = static_cast<std::int32_t>(i);
      }
  }
  if (!tag.empty()) drop_filler_pairs(tag, candidate_start_, candidate_);
  candidate_squared_.resize(candidate_.size());
  built_at_ = position;
  built_tag_.assign(tag.begin(), tag.end());
  valid_ = true;
  ++rebuilds_;
}

template <int dim>
const Neighbours& NeighbourSearch<dim>::update(const Vectors<dim>& position,
                                               std::span<const std::uint8_t> tag, const KeepPair& keep) {
  const auto n = position.cols();
  assert(tag.empty() || tag.size() == static_cast<size_t>(n));
  for (auto& part : parts_) part.fresh = false;
  if (valid_ &&
      (built_at_.cols() != n || !std::equal(tag.begin(), tag.end(), built_tag_.begin(), built_tag_.end())))
    valid_ = false;
  if (valid_) {
    // Two particles that each moved by less than half the skin were within radius + skin when the cells were
    // built.
    const double limit = 0.25 * skin_ * skin_;
    for (Eigen::Index i = 0; i < n && valid_; ++i)
      if (!(squared_distance<dim>(position.col(i).data(), built_at_.col(i).data(), periodic_) <= limit))
        valid_ = false;
  }
  if (!valid_) rebuild(position, tag);

  const double squared = radius_ * radius_, nearest = squared * coincident * coincident;
  const double dropped = std::numeric_limits<double>::infinity();
  exact_.start_.resize(static_cast<size_t>(n) + 1);
  exact_.start_[0] = 0;
  const double* x = position.data();
  const bool ask = keep && !tag.empty();
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto first = candidate_start_[static_cast<size_t>(i)],
               last = candidate_start_[static_cast<size_t>(i) + 1];
    const std::int32_t* column = candidate_.data();
    double* square = candidate_squared_.data();
    std::array<double, dim> at;
    for (int d = 0; d < dim; ++d) at[static_cast<size_t>(d)] = x[dim * i + d];
#pragma omp simd
    for (auto c = first; c < last; ++c) {
      double sum = 0;
      for (int d = 0; d < dim; ++d) {
        const double difference = periodic_.nearest(x[dim * column[c] + d] - at[static_cast<size_t>(d)], d);
        sum += difference * difference;
      }
      square[c] = sum > nearest ? sum : dropped;
    }
    if (ask)
      for (auto c = first; c < last; ++c)
        if (((tag[static_cast<size_t>(i)] | tag[static_cast<size_t>(column[c])]) & asked) &&
            square[c] < squared && !keep(static_cast<std::int32_t>(i), column[c]))
          square[c] = dropped;
    std::int64_t within = 0;
    for (auto c = first; c < last; ++c) within += square[c] < squared ? 1 : 0;
    exact_.start_[static_cast<size_t>(i) + 1] = within;
  }
  for (size_t i = 1; i < exact_.start_.size(); ++i) exact_.start_[i] += exact_.start_[i - 1];
  const auto pairs = static_cast<size_t>(exact_.start_.back());
  exact_.column_.resize(pairs);
  exact_.distance_.resize(pairs);
  exact_.inverse_.resize(pairs);
#pragma omp parallel for schedule(static)
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto first = candidate_start_[static_cast<size_t>(i)],
               last = candidate_start_[static_cast<size_t>(i) + 1];
    std::int32_t* column = exact_.column_.data();
    double* squares = exact_.distance_.data();
    auto k = exact_.start_[static_cast<size_t>(i)];
    std::array<std::uint8_t, chunk> selected;
    for (auto c = first; c < last; c += static_cast<std::int64_t>(chunk)) {
      const double* square = candidate_squared_.data() + c;
      const auto used =
          select_below(square, squared, std::min(chunk, static_cast<size_t>(last - c)), selected);
      for (size_t m = 0; m < used; ++m, ++k) {
        column[k] = candidate_[static_cast<size_t>(c) + selected[m]];
        squares[k] = square[selected[m]];
      }
    }
  }
  double *distance = exact_.distance_.data(), *inverse = exact_.inverse_.data();
#pragma omp parallel for simd schedule(static)
  for (size_t k = 0; k < pairs; ++k) {
    distance[k] = std::sqrt(distance[k]);
    inverse[k] = 1.0 / distance[k];
  }
  return exact_;
}

template <int dim>
const Neighbours& NeighbourSearch<dim>::within(double radius) {
  assert(radius <= radius_ && exact_.size() > 0);
  if (radius == radius_) return exact_;
  auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.radius == radius; });
  if (part == parts_.end()) part = parts_.insert(part, Part{radius, false, {}});
  if (part->fresh) return part->rows;
  auto& rows = part->rows;
  const auto n = exact_.size();
  rows.start_.resize(static_cast<size_t>(n) + 1);
  rows.start_[0] = 0;
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    std::int64_t count = 0;
    for (const double r : exact_.distances(i)) count += r < radius ? 1 : 0;
    rows.start_[static_cast<size_t>(i) + 1] = count;
  }
  for (size_t i = 1; i < rows.start_.size(); ++i) rows.start_[i] += rows.start_[i - 1];
  const auto pairs = static_cast<size_t>(rows.start_.back());
  rows.column_.resize(pairs);
  rows.distance_.resize(pairs);
  rows.inverse_.resize(pairs);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    auto k = static_cast<size_t>(rows.start_[static_cast<size_t>(i)]);
    const auto last = static_cast<size_t>(exact_.start_[static_cast<size_t>(i) + 1]);
    std::array<std::uint8_t, chunk> selected;
    for (auto e = static_cast<size_t>(exact_.start_[static_cast<size_t>(i)]); e < last; e += chunk) {
      const auto used =
          select_below(exact_.distance_.data() + e, radius, std::min(chunk, last - e), selected);
      for (size_t m = 0; m < used; ++m, ++k) {
        rows.column_[k] = exact_.column_[e + selected[m]];
        rows.distance_[k] = exact_.distance_[e + selected[m]];
        rows.inverse_[k] = exact_.inverse_[e + selected[m]];
      }
    }
  }
  part->fresh = true;
  return rows;
}

template class NeighbourSearch<2>;
template class NeighbourSearch<3>;

}  // namespace strake::fluid
