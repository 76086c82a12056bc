#include "fluid/pressure_solver/aggregates.hpp"

#include "fluid/pressure_solver/ranked_unknowns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace strake::fluid {

namespace {
/// Number of rows below which threads cost more time than they save.
constexpr std::int64_t rows_for_threads = 4000;

/// The box of the unknowns, from `low` to `high`. `most`: the largest number of cells.
template <int dim>
struct UnknownsBox {
  std::array<double, dim> low, high;
  double most;
};

template <int dim>
UnknownsBox<dim> bounds(const PressureSystem& system, const Vectors<dim>& position) {
  const std::int64_t n = system.size();
  const std::int32_t* particle = system.particle.data();
  UnknownsBox<dim> box{.low = {}, .high = {}, .most = 4 * static_cast<double>(n) + 10000};
  for (std::size_t d = 0; d < dim; ++d) {
    double least = std::numeric_limits<double>::max(), largest = std::numeric_limits<double>::lowest();
#pragma omp parallel for schedule(static) reduction(min                    \
                                                    : least) reduction(max \
                                                                       : largest) if (n >= rows_for_threads)
    for (std::int64_t k = 0; k < n; ++k) {
      const double x = position(static_cast<Eigen::Index>(d), particle[k]);
      least = std::min(least, x);
      largest = std::max(largest, x);
    }
    box.low[d] = least;
    box.high[d] = largest;
  }
  return box;
}

/// Cuts the box to one around the median of each coordinate.
template <int dim>
void cut_to_median(const PressureSystem& system, const Vectors<dim>& position, double cell_size,
                   UnknownsBox<dim>& box) {
  const std::int64_t n = system.size();
  const double reach = 0.5 * std::pow(box.most, 1.0 / dim) * cell_size;
  std::vector<double> coordinate(static_cast<std::size_t>(n));
  for (std::size_t d = 0; d < dim; ++d) {
    for (std::int64_t k = 0; k < n; ++k)
      coordinate[static_cast<std::size_t>(k)] =
          position(static_cast<Eigen::Index>(d), system.particle.data()[k]);
    const auto middle_one = coordinate.begin() + n / 2;
    std::nth_element(coordinate.begin(), middle_one, coordinate.end());
    box.low[d] = std::max(box.low[d], *middle_one - reach);
    box.high[d] = std::min(box.high[d], *middle_one + reach);
  }
}

}  // namespace

/// Sorts the unknowns into cells of a box around them. Where a few far particles would make the box much
/// larger than the water, it is one around the median. Particles outside are sorted into its edge cells.
/// Clamping moves no two particles apart, so rows still reach only adjacent cells.
template <int dim>
void Aggregates<dim>::sort(const PressureSystem& system, const Vectors<dim>& position, double cell_size,
                           double full) {
  const std::int64_t n = system.size();
  const std::int32_t* particle = system.particle.data();
  UnknownsBox<dim> box = bounds<dim>(system, position);
  const std::array<double, dim>&low = box.low, &high = box.high;
  const double most = box.most;
  double cells = 1;
  for (std::size_t d = 0; d < dim; ++d) cells *= (high[d] - low[d]) / cell_size + 3;
  if (!(cells < most)) cut_to_median<dim>(system, position, cell_size, box);
  ranked_ = nullptr;
  piece_owner_.clear();
  std::array<double, dim> extent{};
  for (std::size_t d = 0; d < dim; ++d) {
    const double wide = (high[d] - low[d]) / cell_size;
    extent[d] = (wide > 0 && wide < most ? std::floor(wide) : 0) + 1;
    count_[d] = static_cast<std::int32_t>(extent[d]) + 2;
  }
  for (auto& coordinate : at) coordinate.resize(static_cast<std::size_t>(n));
  cell_.resize(static_cast<std::size_t>(n));
  constexpr double edge = 1e-3;
#pragma omp parallel for schedule(static) if (n >= rows_for_threads)
  for (std::int64_t k = 0; k < n; ++k) {
    for (std::size_t d = 0; d < dim; ++d) {
      const double u = (position(static_cast<Eigen::Index>(d), particle[k]) - low[d]) / cell_size;
      // The form of this condition places a coordinate that is no number at the edge, too.
      at[d][static_cast<std::size_t>(k)] =
          static_cast<float>(u > 0 ? (u < extent[d] - edge ? u : extent[d] - edge) : 0.0);
    }
    cell_[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(cell_of(k));
  }
  order.resize(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  const std::vector<std::int32_t> every = std::move(order);
  sort_by_cell(every, full);
}

template <int dim>
void Aggregates<dim>::sort(const RankedUnknowns<dim>& unknowns, double full) {
  ranked_ = &unknowns;
  rank_ = unknowns.communicator->rank();
  at = unknowns.at;
  for (std::size_t d = 0; d < dim; ++d) count_[d] = unknowns.cells[d] + 2;
  cell_.resize(at.front().size());
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < cell_.size(); ++k)
    cell_[k] = static_cast<std::int32_t>(cell_of(static_cast<std::int64_t>(k)));
  sort_by_cell(unknowns.in_cells, full);
}

/// Sorts the listed unknowns by their cells, those of one cell in their order.
template <int dim>
void Aggregates<dim>::sort_by_cell(std::span<const std::int32_t> sorted, double full) {
  std::int64_t all = 1;
  for (std::size_t d = 0; d < dim; ++d) all *= count_[d];
  cell_start_.assign(static_cast<std::size_t>(all) + 1, 0);
  for (const std::int32_t k : sorted)
    ++cell_start_[static_cast<std::size_t>(cell_[static_cast<std::size_t>(k)]) + 1];
  for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  order.resize(sorted.size());
  first_piece_.assign(cell_start_.begin(), cell_start_.end());  // as a cursor, for now
  for (const std::int32_t k : sorted)
    order[static_cast<std::size_t>(
        first_piece_[static_cast<std::size_t>(cell_[static_cast<std::size_t>(k)])]++)] = k;
  touched.resize(cell_.size());
  own_cell_entries.resize(cell_.size());
  find_sparse(full);
}

template <int dim>
void Aggregates<dim>::find_sparse(double full) {
  const auto cells = static_cast<std::int64_t>(cell_start_.size()) - 1;
  density_.assign(static_cast<std::size_t>(cells), 0);
  for (std::int64_t c = 0; c < cells; ++c) {
    const auto here = static_cast<std::size_t>(c);
    const std::int32_t unknowns = cell_start_[here + 1] - cell_start_[here];
    if (unknowns == 0 || 2 * unknowns >= full) continue;
    for (int near = 0; near < around; ++near) {
      const std::int64_t step = step_to(near);
      std::uint8_t& other = density_[static_cast<std::size_t>(c + step)];  // the ring around is empty
      other = std::max<std::uint8_t>(other, step == 0 ? 2 : 1);
    }
  }
}

template <int dim>
std::int64_t Aggregates<dim>::cell_of(std::int64_t unknown) const {
  std::int64_t c = 0;
  for (std::size_t d = dim; d-- > 0;)
    c = c * count_[d] + static_cast<std::int64_t>(at[d][static_cast<std::size_t>(unknown)]) + 1;
  return c;
}

template <int dim>
void Aggregates<dim>::split(const PressureSystem& system, CoarseLevel<dim>& level) {
  if (ranked_) share_parts(system);
  split_cells(system);
  link_pieces(system);
  if (ranked_) share_links();
  gather_vertices(level);
}

/// Whether one unknown touches all others of its cell; the cell is then one piece.
template <int dim>
bool Aggregates<dim>::is_whole(std::int64_t begin, std::int64_t end) const {
  for (std::int64_t s = begin; s < end; ++s)
    if (own_cell_entries[static_cast<std::size_t>(order[static_cast<std::size_t>(s)])] >= end - begin - 1)
      return true;
  return false;
}

template <int dim>
void Aggregates<dim>::split_cells(const PressureSystem& system) {
  const auto cells = static_cast<std::int64_t>(cell_start_.size()) - 1;
  first_piece_.resize(cell_start_.size());
  piece_start.clear();
  piece_touches_.clear();
  shared_cell_.clear();
  piece_of.assign(cell_.size(), -1);
  for (std::int64_t c = 0; c < cells; ++c) {
    const auto here = static_cast<std::size_t>(c);
    const std::int64_t begin = cell_start_[here], end = cell_start_[here + 1];
    first_piece_[here] = static_cast<std::int32_t>(piece_start.size());
    if (begin == end) continue;
    if (ranked_)
      start_parts(begin, end);
    else if (is_whole(begin, end))
      piece_start.push_back(static_cast<std::int32_t>(begin));
    else
      find_parts(system, begin, end);
    const auto first = static_cast<std::size_t>(first_piece_[here]);
    for (std::size_t p = first; p < piece_start.size(); ++p) {
      shared_cell_.push_back(piece_start.size() - first > 1 ? 1 : 0);
      const std::int64_t stop = p + 1 < piece_start.size() ? piece_start[p + 1] : end;
      std::uint32_t bits = 0;
      for (std::int64_t s = piece_start[p]; s < stop; ++s) {
        const auto k = static_cast<std::size_t>(order[static_cast<std::size_t>(s)]);
        bits |= touched[k];
        piece_of[k] = static_cast<std::int32_t>(p);
      }
      piece_touches_.push_back(bits);
    }
  }
  first_piece_.back() = static_cast<std::int32_t>(piece_start.size());
  piece_start.push_back(static_cast<std::int32_t>(order.size()));
  if (ranked_ == nullptr) return;
  piece_owner_.clear();
  for (std::int32_t p = 0; p < pieces(); ++p)
    piece_owner_.push_back(ranked_->owner[static_cast<std::size_t>(
        order[static_cast<std::size_t>(piece_start[static_cast<std::size_t>(p)])])]);
}

/// Sorts one cell's stretch of `order` into pieces, which are connected through rows inside the cell.
template <int dim>
void Aggregates<dim>::find_parts(const PressureSystem& system, std::int64_t begin, std::int64_t end) {
  std::int32_t* const stretch = order.data();
  const std::int32_t cell = cell_[static_cast<std::size_t>(stretch[begin])];
  std::int64_t found = begin;
  while (found < end) {
    piece_start.push_back(static_cast<std::int32_t>(found));
    std::int64_t next = found++;
    for (; next < found; ++next) {
      const auto k = static_cast<std::size_t>(stretch[next]);
      for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
        const std::int32_t j = system.column[static_cast<std::size_t>(e)];
        if (cell_[static_cast<std::size_t>(j)] != cell) continue;
        std::int32_t* const place = std::find(stretch + found, stretch + end, j);
        if (place != stretch + end) std::swap(*place, stretch[found++]);
      }
    }
  }
}

template <int dim>
void Aggregates<dim>::link_pieces(const PressureSystem& system) {
  links_.clear();
  const std::vector<std::uint8_t> beside = ranked_ ? pieces_to_link() : std::vector<std::uint8_t>();
  const std::vector<std::uint8_t>& linking = ranked_ ? beside : shared_cell_;
  for (std::int32_t p = 0; p < pieces(); ++p) {
    if (!linking[static_cast<std::size_t>(p)]) continue;
    for (std::int32_t s = piece_start[static_cast<std::size_t>(p)];
         s < piece_start[static_cast<std::size_t>(p) + 1]; ++s) {
      const auto k = static_cast<std::size_t>(order[static_cast<std::size_t>(s)]);
      for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
        const std::int32_t q = piece_of[static_cast<std::size_t>(system.column[static_cast<std::size_t>(e)])];
        if (q == p || q < 0) continue;  // −1: of the second ring
        if (!shared_cell_[static_cast<std::size_t>(p)] && !shared_cell_[static_cast<std::size_t>(q)])
          continue;
        links_.emplace_back(p, q);
        links_.emplace_back(q, p);
      }
    }
  }
  std::sort(links_.begin(), links_.end());
  links_.erase(std::unique(links_.begin(), links_.end()), links_.end());
}

template <int dim>
bool Aggregates<dim>::linked(std::int32_t p, std::int32_t q, int direction) const {
  if (!shared_cell_[static_cast<std::size_t>(p)] && !shared_cell_[static_cast<std::size_t>(q)])
    return (piece_touches_[static_cast<std::size_t>(p)] >> direction & 1u) != 0;
  return std::binary_search(links_.begin(), links_.end(), Link{p, q});
}

/// Returns the direction between two cells around a vertex, in the numbering of `touched`. The vertex is
/// corner a of the first cell and corner b of the second. The direction is minus the step between the
/// corners.
template <int dim>
int direction_between(int a, int b) {
  int code = 0, scale = 1;
  for (int d = 0; d < dim; ++d, scale *= 3) code += scale * (1 + (a >> d & 1) - (b >> d & 1));
  return code;
}

template <int dim>
int Aggregates<dim>::join_members(std::vector<Member>& members) const {
  int parts = 0;
  for (std::size_t seed = 0; seed < members.size(); ++seed) {
    if (members[seed].part >= 0) continue;
    members[seed].part = parts;
    for (bool grown = true; grown;) {
      grown = false;
      for (Member& m : members) {
        if (m.part >= 0) continue;
        for (const Member& other : members)
          if (other.part == parts &&
              linked(other.piece, m.piece, direction_between<dim>(other.corner, m.corner))) {
            m.part = parts;
            grown = true;
            break;
          }
      }
    }
    ++parts;
  }
  return parts;
}

/// Notes the owner of a vertex, that of its lowest piece. False: no own piece is there.
template <int dim>
bool Aggregates<dim>::begin_node(const std::vector<Member>& members, int part) {
  int owner = -1;
  bool own = false;
  for (const Member& m : members) {
    if (m.part != part) continue;
    if (owner < 0) owner = piece_owner_[static_cast<std::size_t>(m.piece)];
    own = own || owns(m.piece);
  }
  if (own) node_owner.push_back(owner);
  return own;
}

template <int dim>
void Aggregates<dim>::gather_vertices(CoarseLevel<dim>& level) {
  std::vector<Member> members;
  node.assign(static_cast<std::size_t>(pieces()) * corners, -1);
  meeting_start.assign(1, 0);
  meeting.clear();
  node_owner.clear();
  level.place.clear();
  level.first.assign(1, 0);
  for (std::size_t d = 0; d < 3; ++d) level.size[d] = d < dim ? count_[d] - 1 : 1;
  for (std::int32_t z = 0; z < level.size[2]; ++z)
    for (std::int32_t y = 0; y < level.size[1]; ++y)
      for (std::int32_t x = 0; x < level.size[0]; ++x) {
        members.clear();
        for (int a = corners; a-- > 0;) {  // the lowest cell first
          const std::int32_t i = x + 1 - (a & 1), j = y + 1 - (a >> 1 & 1),
                             k = dim == 3 ? z + 1 - (a >> 2) : 0;
          const auto c =
              static_cast<std::size_t>((static_cast<std::int64_t>(k) * count_[1] + j) * count_[0] + i);
          for (std::int32_t p = first_piece_[c]; p < first_piece_[c + 1]; ++p) members.push_back({p, a, -1});
        }
        typename CoarseLevel<dim>::Place here{};
        const std::array<std::int32_t, 3> xyz{x, y, z};
        for (std::size_t d = 0; d < dim; ++d) here[d] = xyz[d];
        const int parts = join_members(members);
        for (int part = 0; part < parts; ++part) {
          if (ranked_ != nullptr && !begin_node(members, part)) continue;
          for (const Member& m : members) {
            if (m.part != part) continue;
            node[static_cast<std::size_t>(m.piece * corners + m.corner)] = level.unknowns();
            meeting.push_back(m.piece * corners + m.corner);
          }
          level.place.push_back(here);
          meeting_start.push_back(static_cast<std::int32_t>(meeting.size()));
        }
        level.first.push_back(level.unknowns());
      }
}

template <int dim>
std::size_t Aggregates<dim>::bytes() const {
  std::size_t numbers = touched.capacity() + own_cell_entries.capacity() + order.capacity() +
                        piece_start.capacity() + node.capacity() + meeting_start.capacity() +
                        meeting.capacity() + cell_.capacity() + cell_start_.capacity() +
                        first_piece_.capacity() + piece_touches_.capacity() + piece_of.capacity();
  for (const auto& coordinate : at) numbers += coordinate.capacity();
  return 4 * numbers + shared_cell_.capacity() + density_.capacity() + sizeof(Link) * links_.capacity();
}

template class Aggregates<2>;
template class Aggregates<3>;

}  // namespace strake::fluid
