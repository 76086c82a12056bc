#include "fluid/particles/neighbours.hpp"

#include "fluid/particles/running_sum.hpp"
#include "fluid/particles/simd_neighbours.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

namespace strake::fluid {
namespace {

using std::size_t;

/// Share of the radius below which two particles have no direction between them: they are no neighbours.
constexpr double coincident = 1e-9;

/// Smallest skin as a share of the one asked for, used while hardly anything moves.
constexpr double thinnest = 0.1;

/// Number of rows in a block that one thread computes. Threads keep the same rows from loop to loop: rows
/// that another processor has written last cost more than even shares save.
constexpr std::int64_t block = 64;

/// Particles that one thread goes through faster than two where each takes a few operations.
constexpr size_t few = 4096;

/// Bits of a tag on which the candidates depend.
constexpr std::uint8_t of_candidates = filler | absent | passive;

/// Mask of the candidates' bits that mark near partners.
constexpr std::uint32_t near_bits = 0xffff;

template <class T>
size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

template <int dim>
[[noreturn]] void report_not_finite(const Vectors<dim>& position) {
  Eigen::Index i = 0;
  while (position.col(i).array().isFinite().all()) ++i;
  throw Error(ExitCode::solver_fault, "fluid", fmt::format("the position of particle {} is not finite", i),
              "lower fluid.scheme.time_step or fluid.scheme.cfl; look at the last frames for where it began");
}

/// Removes the pairs that `keep` refuses from the kept ones of sixteen partners of particle i.
std::uint32_t asked_for(std::uint32_t kept, std::int32_t i, const std::int32_t* partner,
                        std::span<const std::uint8_t> tag, const KeepPair& keep) {
  for (std::uint32_t rest = kept; rest; rest &= rest - 1) {
    const int k = std::countr_zero(rest);
    if ((tag[static_cast<size_t>(i)] | tag[static_cast<size_t>(partner[k])]) & asked && !keep(i, partner[k]))
      kept &= ~(1U << k);
  }
  return kept;
}

/// Replaces the length of each row by where it ends. start[0] is 0.
void sum_up(std::vector<std::int64_t>& start) {
  running_sum(
      static_cast<std::int64_t>(start.size()) - 1,
      [&](std::int64_t i) { return start[static_cast<size_t>(i) + 1]; },
      [&](std::int64_t i, std::int64_t, std::int64_t to) { start[static_cast<size_t>(i) + 1] = to; });
}

}  // namespace

size_t Neighbours::bytes() const {
  return bytes_of(start_) + bytes_of(column_) + bytes_of(inverse_) + bytes_of(single_);
}

template <int dim>
NeighbourSearch<dim>::NeighbourSearch(double radius, double skin, const Periodic<dim>& periodic,
                                      PairData data)
    : radius_(radius), skin_(skin), periodic_(periodic) {
  assert(radius > 0 && skin >= 0);
  exact_.scale_ = 1 / radius;
  exact_.data_ = data;
  exact_.period_.head<dim>() = periodic.length();
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
  updates_ = 0;
  for (auto& part : parts_) part.fresh = false;
}

template <int dim>
size_t NeighbourSearch<dim>::bytes() const {
  size_t sum = cells_.bytes() + candidates_.bytes() + exact_.bytes() + bytes_of(kept_) +
               bytes_of(meets_asked_) + bytes_of(built_tag_) +
               static_cast<size_t>(built_at_.size()) * sizeof(double);
  for (const Part& part : parts_) sum += part.rows.bytes();
  return sum;
}

/// Returns the longest displacement of a particle since the candidates were found [m]; infinite when a
/// position is not finite.
template <int dim>
double NeighbourSearch<dim>::moved(const Vectors<dim>& position) const {
  double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
  for (Eigen::Index i = 0; i < position.cols(); ++i) {
    double sum = 0;
    for (int d = 0; d < dim; ++d) {
      const double r = periodic_.nearest(position(d, i) - built_at_(d, i), d);
      sum += r * r;
    }
    most = std::max(
        most, sum < std::numeric_limits<double>::infinity() ? sum : std::numeric_limits<double>::infinity());
  }
  return std::sqrt(most);
}

/// Finds the candidates anew, with a skin that fits the motion. way: longest displacement of a particle since
/// the last rebuild [m]. A skin that would not last two updates costs more than it saves.
template <int dim>
void NeighbourSearch<dim>::rebuild(const Vectors<dim>& position, std::span<const std::uint8_t> tag,
                                   double way) {
  if (!std::isfinite(way)) report_not_finite<dim>(position);
  built_skin_ = skin_;
  if (updates_ > 0) {
    const double step = way / static_cast<double>(updates_);
    built_skin_ = 4 * step < skin_ ? std::clamp(4 * std::sqrt(step * skin_), thinnest * skin_, skin_) : 0;
  }
  cells_.find(position, tag, radius_, built_skin_, periodic_, candidates_);
  make_room(kept_, candidates_.bits.size());
  built_at_ = position;
  built_tag_.resize(tag.size());
  std::transform(tag.begin(), tag.end(), built_tag_.begin(),
                 [](std::uint8_t t) { return t & of_candidates; });
  valid_ = true;
  updates_ = 0;
  ++rebuilds_;
}

/// Marks the rows in which `keep` must be asked: those of `asked` particles and of all their candidates.
template <int dim>
void NeighbourSearch<dim>::mark_asked(std::span<const std::uint8_t> tag) {
  meets_asked_.assign(tag.size(), 0);
  const auto mark = [&](size_t i) {  // two threads may mark the same
    std::atomic_ref(meets_asked_[i]).store(1, std::memory_order_relaxed);
  };
#pragma omp parallel for schedule(static) if (tag.size() > few)
  for (size_t i = 0; i < tag.size(); ++i) {
    if (!(tag[i] & asked)) continue;
    mark(i);
    const auto list = candidates_.list(static_cast<std::int64_t>(i));
    size_t word = candidates_.first_bits(static_cast<std::int64_t>(i));
    for (size_t b = 0; b < list.size(); b += simd::wide, ++word)
      for (std::uint32_t near = candidates_.bits[word] & near_bits; near; near &= near - 1)
        mark(static_cast<size_t>(list[b + static_cast<size_t>(std::countr_zero(near))]));
  }
  mark_beside_passive(tag);
}

/// Marks the rows of all cells whose lists contain an asked particle without a row of its own.
template <int dim>
void NeighbourSearch<dim>::mark_beside_passive(std::span<const std::uint8_t> tag) {
  constexpr std::uint8_t both = asked | passive;
  const auto is_sought = [&](std::size_t i) { return (tag[i] & both) == both; };
  bool any = false;
#pragma omp parallel for schedule(static) reduction(|| : any) if (tag.size() > few)
  for (size_t i = 0; i < tag.size(); ++i) any = any || is_sought(i);
  if (!any) return;
  std::vector<std::uint8_t> meets(candidates_.list_start.size(), 0);  // of each list
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < meets.size() - 1; ++c)
    meets[c] = std::any_of(candidates_.lists.begin() + candidates_.list_start[c],
                           candidates_.lists.begin() + candidates_.list_start[c + 1],
                           [&](std::int32_t j) { return is_sought(static_cast<size_t>(j)); });
#pragma omp parallel for schedule(static) if (tag.size() > few)
  for (size_t i = 0; i < tag.size(); ++i) meets_asked_[i] |= meets[static_cast<size_t>(candidates_.cell[i])];
}

/// Selects the candidates within the radius and counts them. Only those at the border need a test. What is
/// packed for a block of rows is read when the block is done: a packed store read at once would stall.
template <int dim>
template <bool seams>
void NeighbourSearch<dim>::select(const double* x, std::span<const std::uint8_t> tag, const KeepPair* keep) {
  const auto n = static_cast<std::int64_t>(built_at_.cols());
  const double squared = radius_ * radius_, nearest = squared * coincident * coincident;
#pragma omp parallel
  {
    std::vector<std::int32_t> looks;
    std::vector<std::uint8_t> found;  // bits of a row's looks
    std::array<const std::int32_t*, block> look_end{};
#pragma omp for schedule(static)
    for (std::int64_t first = 0; first < n; first += block) {
      const std::int64_t last = std::min(n, first + block);
      size_t most = 0;
      for (std::int64_t i = first; i < last; ++i) most += candidates_.list(i).size();
      if (looks.size() < most) looks.resize(most);
      if (found.size() < most / 8 + 8) found.resize(most / 8 + 8);
      std::int32_t* end = looks.data();
      for (std::int64_t i = first; i < last; ++i) {
        const auto list = candidates_.list(i);
        size_t word = candidates_.first_bits(i);
        for (size_t b = 0; b < list.size(); b += simd::wide, ++word)
          end += simd::pack(list.data() + b, candidates_.bits[word] >> simd::wide, end);
        look_end[static_cast<size_t>(i - first)] = end;
      }
      const std::int32_t* look = looks.data();
      for (std::int64_t i = first; i < last; ++i) {
        const std::int32_t* const stop = look_end[static_cast<size_t>(i - first)];
        for (std::uint8_t* eight = found.data(); look < stop; ++eight) {
          const auto count = static_cast<int>(std::min<std::ptrdiff_t>(simd::width, stop - look));
          *eight = static_cast<std::uint8_t>(simd::between<dim, seams>(x, static_cast<std::int32_t>(i), look,
                                                                       count, periodic_, nearest, squared));
          look += count;
        }
        const auto list = candidates_.list(i);
        size_t word = candidates_.first_bits(i), looked = 0;
        std::int64_t count = 0;
        const bool ask = keep && meets_asked_[static_cast<size_t>(i)];
        for (size_t b = 0; b < list.size(); b += simd::wide, ++word) {
          const std::uint32_t bits = candidates_.bits[word], border = bits >> simd::wide;
          std::uint32_t kept = bits & near_bits;
          std::uint32_t next;  // at least sixteen bits behind those of the looks before
          std::memcpy(&next, found.data() + looked / 8, sizeof next);
          kept = (kept & ~border) | simd::deposit(next >> looked % 8, border);
          looked += static_cast<size_t>(std::popcount(border));
          if (ask) kept = asked_for(kept, static_cast<std::int32_t>(i), list.data() + b, tag, *keep);
          kept_[word] = static_cast<std::uint16_t>(kept);
          count += std::popcount(kept);
        }
        exact_.start_[static_cast<size_t>(i) + 1] = count;
      }
    }
  }
}

/// Writes the columns and pair data of the exact rows.
template <int dim>
template <bool seams, bool single>
void NeighbourSearch<dim>::fill(const double* x) {
  const auto n = static_cast<std::int64_t>(built_at_.cols());
  [[maybe_unused]] const double scale = 1 / (radius_ * radius_);
#pragma omp parallel for schedule(static)
  for (std::int64_t first = 0; first < n; first += block) {
    const std::int64_t last = std::min(n, first + block);
    std::int32_t* out = exact_.column_.data() + exact_.start_[static_cast<size_t>(first)];
    for (std::int64_t i = first; i < last; ++i) {
      const auto list = candidates_.list(i);
      size_t word = candidates_.first_bits(i);
      for (size_t b = 0; b < list.size(); b += simd::wide, ++word)
        out += simd::pack(list.data() + b, kept_[word], out);
    }
    for (std::int64_t i = first; i < last; ++i) {
      const auto begin = exact_.start_[static_cast<size_t>(i)],
                 end = exact_.start_[static_cast<size_t>(i) + 1];
      const auto self = static_cast<std::int32_t>(i);
      for (auto k = begin; k < end; k += simd::width) {
        const std::int32_t* const others = exact_.column_.data() + k;
        const int count = static_cast<int>(std::min<std::int64_t>(simd::width, end - k));
        if constexpr (single)
          simd::entries<dim, seams>(x, self, others, count, periodic_, scale, exact_.single_.data() + k);
        else
          simd::inverse_lengths<dim, seams>(x, self, others, count, periodic_, exact_.inverse_.data() + k);
      }
    }
  }
}

template <int dim>
const Neighbours& NeighbourSearch<dim>::update(const Vectors<dim>& position,
                                               std::span<const std::uint8_t> tag, const KeepPair& keep) {
  const auto n = position.cols();
  assert(tag.empty() || tag.size() == static_cast<size_t>(n));
  for (auto& part : parts_) part.fresh = false;
  if (built_at_.cols() != n || built_tag_.size() != tag.size()) invalidate();
  unsigned changed = 0;
  const size_t compared = valid_ ? tag.size() : 0;
#pragma omp parallel for schedule(static) reduction(| : changed) if (compared > few)
  for (size_t i = 0; i < compared; ++i) changed |= (tag[i] & of_candidates) ^ built_tag_[i];
  if (changed) valid_ = false;
  // The candidates stay valid while no particle has moved by more than half the skin. Two particles within
  // the radius were then within radius + skin when the candidates were found.
  if (built_at_.cols() != n) built_at_.setZero(dim, n);
  const double way = moved(position);
  if (valid_) ++updates_;
  if (!(way <= 0.5 * built_skin_)) valid_ = false;
  if (!valid_) rebuild(position, tag, way);

  const double* x = position.data();
  const bool seams = periodic_.any(), ask = keep && !tag.empty();
  if (ask) mark_asked(tag);
  exact_.start_.resize(static_cast<size_t>(n) + 1);
  exact_.start_[0] = 0;
  seams ? select<true>(x, tag, ask ? &keep : nullptr) : select<false>(x, tag, ask ? &keep : nullptr);
  sum_up(exact_.start_);
  make_room(exact_.column_, static_cast<size_t>(exact_.start_.back()));
  keeps_entries() ? make_room(exact_.single_, exact_.column_.size())
                  : make_room(exact_.inverse_, exact_.column_.size());
  if (keeps_entries())
    seams ? fill<true, true>(x) : fill<false, true>(x);
  else
    seams ? fill<true, false>(x) : fill<false, false>(x);
  return exact_;
}

template <int dim>
void NeighbourSearch<dim>::lengthen(std::int64_t pair, double length) {
  const auto e = static_cast<size_t>(pair);
  if (keeps_entries())
    exact_.single_[e] = static_cast<float>(1 - radius_ / length);
  else
    exact_.inverse_[e] = 1 / length;
}

template <int dim>
const Neighbours& NeighbourSearch<dim>::within(double radius) {
  assert(radius <= radius_ && exact_.size() > 0);
  if (radius == radius_ && !keeps_entries()) return exact_;
  auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return p.radius == radius; });
  if (part == parts_.end()) part = parts_.insert(part, Part{radius});
  if (!part->fresh) keeps_entries() ? gather_part<true>(*part) : gather_part<false>(*part);
  part->fresh = true;
  return part->rows;
}

/// Selects the rows of a smaller radius: counts first, then fills, sixteen pairs at a time.
template <int dim>
template <bool single>
void NeighbourSearch<dim>::gather_part(Part& part) const {
  Neighbours& rows = part.rows;
  const auto n = exact_.size();
  [[maybe_unused]] const auto scale = static_cast<float>(exact_.scale_);
  rows.data_ = single ? PairData::single_inverses : PairData::inverses;
  rows.period_ = exact_.period_;
  rows.start_.resize(static_cast<size_t>(n) + 1);
  rows.start_[0] = 0;
  const auto chosen = [&](std::int64_t from, std::int64_t last) {
    const int count = static_cast<int>(std::min<std::int64_t>(simd::wide, last - from));
    if constexpr (single)
      return simd::below(exact_.single_.data() + from, count, static_cast<float>(1 - radius_ / part.radius));
    else
      return simd::above(exact_.inverse_.data() + from, count, 1 / part.radius);
  };
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto first = exact_.start_[static_cast<size_t>(i)],
               last = exact_.start_[static_cast<size_t>(i) + 1];
    std::int64_t count = 0;
    for (auto e = first; e < last; e += simd::wide) count += std::popcount(chosen(e, last));
    rows.start_[static_cast<size_t>(i) + 1] = count;
  }
  sum_up(rows.start_);
  make_room(rows.column_, static_cast<size_t>(rows.start_.back()));
  if constexpr (single)
    make_room(rows.single_, rows.column_.size());
  else
    make_room(rows.inverse_, rows.column_.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const auto first = exact_.start_[static_cast<size_t>(i)],
               last = exact_.start_[static_cast<size_t>(i) + 1];
    auto to = rows.start_[static_cast<size_t>(i)];
    for (auto e = first; e < last; e += simd::wide) {
      const std::uint32_t bits = chosen(e, last);
      const int count = simd::pack(exact_.column_.data() + e, bits, rows.column_.data() + to);
      if constexpr (single) {
        simd::pack_inverses(exact_.single_.data() + e, bits, scale, rows.single_.data() + to);
      } else {
        const int low = simd::pack(exact_.inverse_.data() + e, bits & 0xffU, rows.inverse_.data() + to);
        simd::pack(exact_.inverse_.data() + e + simd::width, bits >> simd::width,
                   rows.inverse_.data() + to + low);
      }
      to += count;
    }
  }
}

template class NeighbourSearch<2>;
template class NeighbourSearch<3>;

}  // namespace strake::fluid
