#include "fluid/pressure_solver/ranked_levels.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strake::fluid {
namespace {

/// Most grids above the last one, and number of rows of all ranks from which there is another one. With two
/// hypre takes 2 % of the processor's time, with none 9 % in the plane; each has messages of its own. With
/// three there are eleven iterations instead of ten.
constexpr int most_levels = 2;
constexpr std::int64_t least_rows = 200;

/// The unknowns of the next grid before the choice of `keep_independent`.
struct Proposal {
  std::vector<GridPlace> place;
  SparseRows restriction;
};

std::int32_t half_below(std::int32_t x) {
  return x >= 0 ? x / 2 : -((1 - x) / 2);
}

/// Own unknowns by vertices, in the box around them.
struct VertexTable {
  GridPlace low{}, size{};
  std::vector<std::int32_t> first, unknown;  // first: in unknown, of each vertex, and one more

  std::size_t at(const GridPlace& v) const {
    return static_cast<std::size_t>(
        (static_cast<std::int64_t>(v[2] - low[2]) * size[1] + (v[1] - low[1])) * size[0] + (v[0] - low[0]));
  }
  explicit VertexTable(const std::vector<GridPlace>& place) {
    GridPlace high = low = place.front();
    for (const GridPlace& v : place)
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = std::min(low[d], v[d]);
        high[d] = std::max(high[d], v[d]);
      }
    std::size_t all = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      size[d] = high[d] - low[d] + 1;
      all *= static_cast<std::size_t>(size[d]);
    }
    first.assign(all + 1, 0);
    for (const GridPlace& v : place) ++first[at(v) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    unknown.resize(place.size());
    std::vector<std::int32_t> next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < place.size(); ++i)
      unknown[static_cast<std::size_t>(next[at(place[i])]++)] = static_cast<std::int32_t>(i);
  }
  /// Lists the unknowns at most one vertex from a vertex.
  void around(const GridPlace& centre, std::vector<std::int32_t>& found) const {
    found.clear();
    GridPlace from, to;
    for (std::size_t d = 0; d < 3; ++d) {
      from[d] = std::max(centre[d] - 1, low[d]);
      to[d] = std::min(centre[d] + 1, low[d] + size[d] - 1);
    }
    if (from[0] > to[0]) return;
    for (std::int32_t z = from[2]; z <= to[2]; ++z)
      for (std::int32_t y = from[1]; y <= to[1]; ++y)
        for (auto k = first[at({from[0], y, z})]; k < first[at({to[0], y, z}) + 1]; ++k)
          found.push_back(unknown[static_cast<std::size_t>(k)]);
  }
};

/// Proposes an unknown of the next grid for each connected set of the unknowns around each even vertex, with
/// multilinear weights.
class Proposer {
 public:
  Proposer(const std::vector<GridPlace>& place, const SparseRows& matrix)
      : place_(place), matrix_(matrix), slot_(place.size(), -1) {}
  Proposal propose() {
    Proposal out;
    if (place_.empty()) return out;
    const VertexTable table(place_);
    GridPlace from, to;
    for (std::size_t d = 0; d < 3; ++d) {
      from[d] = half_below(table.low[d]);
      to[d] = half_below(table.low[d] + table.size[d]);
    }
    for (std::int32_t z = from[2]; z <= to[2]; ++z)
      for (std::int32_t y = from[1]; y <= to[1]; ++y)
        for (std::int32_t x = from[0]; x <= to[0]; ++x) {
          table.around({2 * x, 2 * y, 2 * z}, around_);
          add_sets({x, y, z}, out);
        }
    return out;
  }

 private:
  void add_sets(const GridPlace& vertex, Proposal& out) {
    for (const std::int32_t i : around_) slot_[static_cast<std::size_t>(i)] = 0;
    for (const std::int32_t seed : around_) {
      if (slot_[static_cast<std::size_t>(seed)] != 0) continue;
      grow(seed);
      out.place.push_back(vertex);
      for (const std::int32_t i : set_) {
        float weight = 1;
        for (std::size_t d = 0; d < 3; ++d)
          if (place_[static_cast<std::size_t>(i)][d] != 2 * vertex[d]) weight *= 0.5F;
        out.restriction.column.push_back(i);
        out.restriction.value.push_back(weight);
      }
      out.restriction.start.push_back(static_cast<std::int32_t>(out.restriction.column.size()));
    }
    for (const std::int32_t i : around_) slot_[static_cast<std::size_t>(i)] = -1;
  }
  /// Finds the set of `around_` that is connected with the seed.
  void grow(std::int32_t seed) {
    set_.assign(1, seed);
    slot_[static_cast<std::size_t>(seed)] = 1;
    for (std::size_t at = 0; at < set_.size(); ++at) {
      const auto i = static_cast<std::size_t>(set_[at]);
      for (std::int32_t e = matrix_.start[i]; e < matrix_.start[i + 1]; ++e) {
        const auto j = static_cast<std::size_t>(matrix_.column[static_cast<std::size_t>(e)]);
        if (j >= slot_.size() || slot_[j] != 0) continue;
        slot_[j] = 1;
        set_.push_back(static_cast<std::int32_t>(j));
      }
    }
  }
  const std::vector<GridPlace>& place_;
  const SparseRows& matrix_;
  std::vector<std::int32_t> slot_;  // −1 not around, 0 around, 1 in a set
  std::vector<std::int32_t> around_, set_;
};

/// Keeps of the proposed unknowns as many as are linearly independent. At the end of the water and along the
/// bounds of ranks two may reach the same unknowns with the same weights, and the next equation would be
/// singular. One is kept once another unknown reaches it and otherwise kept ones alone.
class Independent {
 public:
  explicit Independent(const SparseRows& restriction, std::int32_t unknowns)
      : restriction_(restriction), state_(static_cast<std::size_t>(restriction.rows()), open) {
    transpose(restriction, unknowns, reached_by_);
    for (std::int32_t i = 0; i < unknowns; ++i) {
      open_.push_back(reached_by_.start[static_cast<std::size_t>(i) + 1] -
                      reached_by_.start[static_cast<std::size_t>(i)]);
      if (open_.back() == 1) ready_.push_back(i);
    }
    keep_ready();
    for (std::int32_t c = restriction.rows(); c-- > 0;) {
      if (state_[static_cast<std::size_t>(c)] != open) continue;
      decide(c, left_out);
      keep_ready();
    }
  }
  bool keeps(std::int32_t c) const { return state_[static_cast<std::size_t>(c)] == kept; }

 private:
  enum State : std::uint8_t { open, kept, left_out };
  void decide(std::int32_t c, State state) {
    state_[static_cast<std::size_t>(c)] = state;
    for (auto e = restriction_.start[static_cast<std::size_t>(c)];
         e < restriction_.start[static_cast<std::size_t>(c) + 1]; ++e) {
      const std::int32_t i = restriction_.column[static_cast<std::size_t>(e)];
      if (--open_[static_cast<std::size_t>(i)] == 1) ready_.push_back(i);
    }
  }
  void keep_ready() {
    while (!ready_.empty()) {
      const auto i = static_cast<std::size_t>(ready_.back());
      ready_.pop_back();
      for (auto e = reached_by_.start[i]; open_[i] == 1 && e < reached_by_.start[i + 1]; ++e)
        if (const std::int32_t c = reached_by_.column[static_cast<std::size_t>(e)];
            state_[static_cast<std::size_t>(c)] == open)
          decide(c, kept);
    }
  }
  const SparseRows& restriction_;
  SparseRows reached_by_;
  std::vector<State> state_;
  std::vector<std::int32_t> open_, ready_;  // open_: of each unknown, how many of those that reach it are
};

/// Makes restriction and prolongation of the unknowns that are kept. The weights of each unknown sum to one.
std::vector<GridPlace> interpolate(const Proposal& all, std::int32_t unknowns, SparseRows& restriction,
                                   SparseRows& prolongation) {
  const Independent choice(all.restriction, unknowns);
  std::vector<GridPlace> place;
  std::vector<float> sum(static_cast<std::size_t>(unknowns), 0);
  restriction.clear();
  for (std::int32_t c = 0; c < all.restriction.rows(); ++c) {
    if (!choice.keeps(c)) continue;
    place.push_back(all.place[static_cast<std::size_t>(c)]);
    for (auto e = static_cast<std::size_t>(all.restriction.start[static_cast<std::size_t>(c)]);
         e < static_cast<std::size_t>(all.restriction.start[static_cast<std::size_t>(c) + 1]); ++e) {
      restriction.column.push_back(all.restriction.column[e]);
      restriction.value.push_back(all.restriction.value[e]);
      sum[static_cast<std::size_t>(restriction.column.back())] += restriction.value.back();
    }
    restriction.start.push_back(static_cast<std::int32_t>(restriction.column.size()));
  }
  for (std::size_t e = 0; e < restriction.column.size(); ++e)
    restriction.value[e] /= sum[static_cast<std::size_t>(restriction.column[e])];
  transpose(restriction, unknowns, prolongation);
  return place;
}

/// One entry of a row that another rank owns.
struct Entry {
  std::int64_t row, column;
  double value;
};

/// The local numbers of columns: own ones first, then those of other ranks, ascending.
class Columns {
 public:
  Columns(std::int64_t first, std::int64_t own) : first_(first), own_(own) {}
  void add(std::int64_t number) {
    if (number < first_ || number >= first_ + own_) others_.push_back(number);
  }
  void sort() {
    std::ranges::sort(others_);
    others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
  }
  std::int32_t of(std::int64_t number) const {
    if (number >= first_ && number < first_ + own_) return static_cast<std::int32_t>(number - first_);
    return static_cast<std::int32_t>(own_ + (std::ranges::lower_bound(others_, number) - others_.begin()));
  }
  std::vector<std::int64_t> numbers() const {
    std::vector<std::int64_t> all(static_cast<std::size_t>(own_));
    std::iota(all.begin(), all.end(), first_);
    all.insert(all.end(), others_.begin(), others_.end());
    return all;
  }

 private:
  std::int64_t first_, own_;
  std::vector<std::int64_t> others_;
};

/// Returns the rank that owns a row. starts: the first row of each rank.
std::size_t owner_of(std::int64_t row, const std::vector<std::int64_t>& starts) {
  return static_cast<std::size_t>(std::ranges::upper_bound(starts, row) - starts.begin()) - 1;
}

}  // namespace

/// Numbers the own rows behind those of the lower ranks. Returns the first row of each rank, and one more.
std::vector<std::int64_t> RankedLevels::find_first(Level& level) const {
  std::vector<std::int64_t> starts(1, 0);
  for (const std::int64_t count : ranks_.all(std::int64_t{level.own()}))
    starts.push_back(starts.back() + count);
  level.first = starts[static_cast<std::size_t>(ranks_.rank())];
  return starts;
}

/// Adds the parts of the own rows that other ranks have to the own ones.
void RankedLevels::assemble(const SharedRows& rows, Level& level) const {
  level.place.assign(rows.place.begin(), rows.place.end());
  const std::vector<std::int64_t> starts = find_first(level);
  const std::int64_t own = level.own();
  std::vector<Bytes> to(starts.size() - 1);
  std::vector<std::int32_t> local(static_cast<std::size_t>(own), -1);
  Columns columns(level.first, own);
  const auto each_entry = [&](std::size_t i, auto&& visit) {
    visit(rows.number[i], static_cast<double>(rows.diagonal[i]));
    for (auto e = static_cast<std::size_t>(rows.start[i]); e < static_cast<std::size_t>(rows.start[i + 1]);
         ++e)
      visit(rows.number[static_cast<std::size_t>(rows.column[e])], static_cast<double>(rows.value[e]));
  };
  for (std::size_t i = 0; i < rows.diagonal.size(); ++i) {
    const std::int64_t row = rows.number[i] - level.first;
    if (row >= 0 && row < own) {
      local[static_cast<std::size_t>(row)] = static_cast<std::int32_t>(i);
      each_entry(i, [&](std::int64_t column, double) { columns.add(column); });
    } else {
      Bytes& bytes = to[owner_of(rows.number[i], starts)];
      each_entry(i, [&](std::int64_t column, double value) {
        append(bytes, Entry{rows.number[i], column, value});
      });
    }
  }
  std::vector<Entry> more;
  for (const Bytes& bytes : ranks_.exchange_any(to))
    for (const Entry& entry : values_of<Entry>(bytes)) {
      more.push_back(entry);
      columns.add(entry.column);
    }
  std::ranges::stable_sort(more, {}, &Entry::row);
  columns.sort();
  level.number = columns.numbers();
  level.matrix.clear();
  level.diagonal.clear();
  RowGatherer gatherer;
  gatherer.resize(std::ssize(level.number));
  auto next = more.begin();
  for (std::int32_t i = 0; i < own; ++i) {
    each_entry(static_cast<std::size_t>(local[static_cast<std::size_t>(i)]),
               [&](std::int64_t column, double value) { gatherer.add(columns.of(column), value); });
    for (; next != more.end() && next->row == level.first + i; ++next)
      gatherer.add(columns.of(next->column), next->value);
    level.diagonal.push_back(static_cast<float>(gatherer.finish(i, level.matrix)));
  }
  list_halo(level, starts);
  level.prepare();
}

/// Asks the owners of the other columns for their values.
void RankedLevels::list_halo(Level& level, const std::vector<std::int64_t>& starts) const {
  level.halo.clear(ranks_.size());
  std::vector<Bytes> asked(level.halo.send.size());
  for (auto k = static_cast<std::size_t>(level.own()); k < level.number.size(); ++k) {
    const std::size_t owner = owner_of(level.number[k], starts);
    level.halo.receive[owner].push_back(static_cast<std::int32_t>(k));
    append(asked[owner], level.number[k]);
  }
  const std::vector<Bytes> wanted = ranks_.exchange_any(asked);
  for (std::size_t r = 0; r < wanted.size(); ++r)
    for (const std::int64_t number : values_of<std::int64_t>(wanted[r]))
      level.halo.send[r].push_back(static_cast<std::int32_t>(number - level.first));
}

void RankedLevels::Level::prepare() {
  const auto n = static_cast<std::size_t>(own());
  inverse.resize(n);
  right.resize(n);
  rest.resize(n);
  solution.assign(number.size(), 0);
  for (std::size_t i = 0; i < n; ++i) {
    double off = 0;
    for (auto e = static_cast<std::size_t>(matrix.start[i]);
         e < static_cast<std::size_t>(matrix.start[i + 1]); ++e)
      off += std::abs(static_cast<double>(matrix.value[e]));
    inverse[i] = static_cast<float>(damped_inverse(diagonal[i], off, grid_damping));
  }
}

SharedRows RankedLevels::Level::rows() const {
  return {.first = first,
          .own = own(),
          .number = number,
          .start = matrix.start,
          .column = matrix.column,
          .value = matrix.value,
          .diagonal = diagonal,
          .place = place};
}

/// Returns the prolongation of the columns of other ranks, and gives `next` its numbers.
SparseRows RankedLevels::interpolation_of_others(const Level& here, Level& next) const {
  struct Weight {
    std::int64_t number;
    float value;
    std::int32_t last;  // of this unknown
  };
  std::vector<Bytes> to(here.halo.send.size());
  for (std::size_t r = 0; r < to.size(); ++r)
    for (const std::int32_t i : here.halo.send[r]) {
      const std::int32_t end = here.prolongation.start[static_cast<std::size_t>(i) + 1];
      for (std::int32_t e = here.prolongation.start[static_cast<std::size_t>(i)]; e < end; ++e)
        append(to[r], Weight{next.first + here.prolongation.column[static_cast<std::size_t>(e)],
                             here.prolongation.value[static_cast<std::size_t>(e)], e + 1 == end ? 1 : 0});
    }
  Columns columns(next.first, next.own());
  std::vector<std::vector<Weight>> of(here.number.size() - static_cast<std::size_t>(here.own()));
  const std::vector<Bytes> from = ranks_.exchange_any(to);
  for (std::size_t r = 0; r < from.size(); ++r) {
    auto column = here.halo.receive[r].begin();
    for (const Weight& weight : values_of<Weight>(from[r])) {
      columns.add(weight.number);
      of[static_cast<std::size_t>(*column - here.own())].push_back(weight);
      if (weight.last) ++column;
    }
  }
  columns.sort();
  next.number = columns.numbers();
  SparseRows out;
  for (const auto& weights : of) {
    for (const Weight& weight : weights) {
      out.column.push_back(columns.of(weight.number));
      out.value.push_back(weight.value);
    }
    out.start.push_back(static_cast<std::int32_t>(out.column.size()));
  }
  return out;
}

/// Makes the next level by the Galerkin product R A Rᵀ. Returns false where it would have more than 0.8 of
/// the rows.
bool RankedLevels::coarsen(Level& here, Level& next) const {
  next.place = interpolate(Proposer(here.place, here.matrix).propose(), here.own(), here.restriction,
                           here.prolongation);
  const std::vector<std::int64_t> starts = find_first(next);
  if (static_cast<double>(starts.back()) > 0.8 * static_cast<double>(ranks_.sum(std::int64_t{here.own()})))
    return false;
  const SparseRows others = interpolation_of_others(here, next);
  next.matrix.clear();
  next.diagonal.clear();
  RowGatherer gatherer;
  gatherer.resize(std::ssize(next.number));
  const auto spread = [&](std::int32_t i, double value) {
    const bool is_own = i < here.own();
    const SparseRows& rows = is_own ? here.prolongation : others;
    const auto row = static_cast<std::size_t>(is_own ? i : i - here.own());
    for (auto e = static_cast<std::size_t>(rows.start[row]);
         e < static_cast<std::size_t>(rows.start[row + 1]); ++e)
      gatherer.add(rows.column[e], value * rows.value[e]);
  };
  for (std::int32_t c = 0; c < next.own(); ++c) {
    for (auto e = static_cast<std::size_t>(here.restriction.start[static_cast<std::size_t>(c)]);
         e < static_cast<std::size_t>(here.restriction.start[static_cast<std::size_t>(c) + 1]); ++e) {
      const auto i = static_cast<std::size_t>(here.restriction.column[e]);
      const double weight = here.restriction.value[e];
      spread(static_cast<std::int32_t>(i), weight * here.diagonal[i]);
      for (auto f = static_cast<std::size_t>(here.matrix.start[i]);
           f < static_cast<std::size_t>(here.matrix.start[i + 1]); ++f)
        spread(here.matrix.column[f], weight * here.matrix.value[f]);
    }
    next.diagonal.push_back(static_cast<float>(gatherer.finish(c, next.matrix)));
  }
  list_halo(next, starts);
  next.prepare();
  return true;
}

void RankedLevels::build(const SharedRows& rows) {
  assemble(rows, levels_.front());
  for (used_ = 0; used_ < most_levels; ++used_) {
    if (levels_.size() < static_cast<std::size_t>(used_) + 2) levels_.emplace_back();
    Level& here = levels_[static_cast<std::size_t>(used_)];
    if (ranks_.sum(std::int64_t{here.own()}) < least_rows ||
        !coarsen(here, levels_[static_cast<std::size_t>(used_) + 1]))
      break;
  }
  last_->build(levels_[static_cast<std::size_t>(used_)].rows());
}

void RankedLevels::solve(std::span<const float> right, std::span<float> solution) {
  descend(0, right, solution);
}

/// Computes one cycle from this level down:
///   x = D⁻¹b; x += P A_c⁻¹ Pᵀ(b − A x); x += D⁻¹(b − A x).
void RankedLevels::descend(std::size_t level, std::span<const float> right, std::span<float> solution) {
  if (level == static_cast<std::size_t>(used_)) {
    last_->solve(right, solution);
    return;
  }
  Level &here = levels_[level], &next = levels_[level + 1];
  const auto n = static_cast<std::int64_t>(here.own());
  const float *b = right.data(), *inverse = here.inverse.data(), *diagonal = here.diagonal.data();
  float *x = here.solution.data(), *r = here.rest.data();
  const auto find_rest = [&] {
    here.halo.update(ranks_, x);
    for (std::int64_t i = 0; i < n; ++i) r[i] = b[i] - diagonal[i] * x[i] - here.matrix.times(x, i);
  };
  for (std::int64_t i = 0; i < n; ++i) x[i] = inverse[i] * b[i];
  find_rest();
  for (std::int64_t c = 0; c < next.own(); ++c)
    next.right[static_cast<std::size_t>(c)] = here.restriction.times(r, c);
  descend(level + 1, next.right, std::span(next.solution).first(static_cast<std::size_t>(next.own())));
  for (std::int64_t i = 0; i < n; ++i) x[i] += here.prolongation.times(next.solution.data(), i);
  find_rest();
  for (std::int64_t i = 0; i < n; ++i) x[i] += inverse[i] * r[i];
  if (solution.data() != x) std::copy_n(x, n, solution.begin());
}

}  // namespace strake::fluid
