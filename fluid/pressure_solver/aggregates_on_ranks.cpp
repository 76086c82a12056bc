#include "fluid/pressure_solver/aggregates.hpp"
#include "fluid/pressure_solver/ranked_unknowns.hpp"

#include <algorithm>
#include <cstring>

// The pieces of cells on several ranks. A cell has one owner, whose rows tell how it is divided; copies of
// its unknowns have no rows elsewhere. So the owners send the parts, and which pieces are linked where a cell
// has several.

namespace strake::fluid {

/// Divides the own cells into parts. Gives the copies of each unknown its part and the cells that its row
/// touches, and sorts copied cells by parts.
template <int dim>
void Aggregates<dim>::share_parts(const PressureSystem& system) {
  const auto cells = static_cast<std::int64_t>(cell_start_.size()) - 1;
  part_.assign(cell_.size(), 0);
  const auto for_each_cell = [&](bool own, auto&& visit) {
    for (std::int64_t c = 0; c < cells; ++c) {
      const auto here = static_cast<std::size_t>(c);
      const std::int64_t begin = cell_start_[here], end = cell_start_[here + 1];
      if (begin < end && is_own_cell(begin) == own) visit(begin, end);
    }
  };
  for_each_cell(true, [&](std::int64_t begin, std::int64_t end) {
    if (is_whole(begin, end)) return;
    piece_start.clear();
    find_parts(system, begin, end);
    piece_start.push_back(static_cast<std::int32_t>(end));
    for (std::size_t p = 0; p + 1 < piece_start.size(); ++p)
      for (std::int32_t s = piece_start[p]; s < piece_start[p + 1]; ++s)
        part_[static_cast<std::size_t>(order[static_cast<std::size_t>(s)])] = static_cast<std::int32_t>(p);
  });
  ranked_->halo->update(
      *ranked_->communicator, sizeof(std::uint32_t) + sizeof(std::int32_t),
      [&](std::int32_t k, std::byte* to) {
        std::memcpy(to, &touched[static_cast<std::size_t>(k)], sizeof(std::uint32_t));
        std::memcpy(to + sizeof(std::uint32_t), &part_[static_cast<std::size_t>(k)], sizeof(std::int32_t));
      },
      [&](std::int32_t k, const std::byte* from) {
        std::memcpy(&touched[static_cast<std::size_t>(k)], from, sizeof(std::uint32_t));
        std::memcpy(&part_[static_cast<std::size_t>(k)], from + sizeof(std::uint32_t), sizeof(std::int32_t));
      });
  const auto part = [&](std::int32_t k) { return part_[static_cast<std::size_t>(k)]; };
  for_each_cell(false, [&](std::int64_t begin, std::int64_t end) {
    const std::span cell(order.data() + begin, static_cast<std::size_t>(end - begin));
    if (!std::ranges::is_sorted(cell, {}, part)) std::ranges::stable_sort(cell, {}, part);
  });
}

/// Begins a piece for each part of a cell, whose unknowns stand part by part.
template <int dim>
void Aggregates<dim>::start_parts(std::int64_t begin, std::int64_t end) {
  std::int32_t before = -1;
  for (std::int64_t s = begin; s < end; ++s) {
    const std::int32_t part = part_[static_cast<std::size_t>(order[static_cast<std::size_t>(s)])];
    if (part != before) piece_start.push_back(static_cast<std::int32_t>(s));
    before = part;
  }
}

/// Marks the own pieces whose rows tell of links: those that share their cell, and those beside a copied cell
/// with several pieces.
template <int dim>
std::vector<std::uint8_t> Aggregates<dim>::pieces_to_link() const {
  std::vector<std::uint8_t> marked(shared_cell_.size(), 0);
  const auto of = [](std::int64_t at) { return static_cast<std::size_t>(at); };
  for (std::int32_t p = 0; p < pieces(); ++p) {
    if (!shared_cell_[of(p)]) continue;
    if (owns(p)) {
      marked[of(p)] = 1;
      continue;
    }
    const std::int64_t c = cell_[of(order[of(piece_start[of(p)])])];
    for (int near = 0; near < around; ++near) {
      const std::size_t other = of(c + step_to(near));
      for (std::int32_t q = first_piece_[other]; q < first_piece_[other + 1]; ++q)
        if (owns(q)) marked[of(q)] = 1;
    }
  }
  return marked;
}

/// Sends the links of own pieces to the ranks that have copies of them. A piece is named by the place of one
/// of its unknowns.
template <int dim>
void Aggregates<dim>::share_links() {
  using Named = std::array<std::int64_t, 2>;
  const auto of = [](std::int64_t at) { return static_cast<std::size_t>(at); };
  const auto name_of = [&](std::int32_t piece) {
    return ranked_->place[of(order[of(piece_start[of(piece)])])];
  };
  const auto& send = ranked_->halo->send;
  std::vector<Bytes> to(send.size());
  for (std::size_t r = 0; r < send.size() && !links_.empty(); ++r) {
    std::vector<std::uint8_t> is_copied(of(pieces()), 0);
    for (const std::int32_t k : send[r])
      if (const std::int32_t piece = piece_of[of(k)]; piece >= 0) is_copied[of(piece)] = 1;
    for (const auto& [p, q] : links_)
      if (owns(p) && is_copied[of(p)]) append(to[r], Named{name_of(p), name_of(q)});
  }
  const auto piece_with = [&](std::int64_t place) {
    const auto found = std::ranges::lower_bound(ranked_->place, place);
    return found != ranked_->place.end() && *found == place ? piece_of[of(found - ranked_->place.begin())]
                                                            : std::int32_t{-1};
  };
  const std::size_t before = links_.size();
  for (const Bytes& bytes : ranked_->communicator->exchange_any(to))
    for (const Named& named : values_of<Named>(bytes)) {
      const std::int32_t p = piece_with(named[0]), q = piece_with(named[1]);
      if (p < 0 || q < 0) continue;
      links_.emplace_back(p, q);
      links_.emplace_back(q, p);
    }
  if (links_.size() == before) return;
  std::sort(links_.begin(), links_.end());
  links_.erase(std::unique(links_.begin(), links_.end()), links_.end());
}

#define STRAKE_INSTANTIATE(dim)                                               \
  template void Aggregates<dim>::share_parts(const PressureSystem&);          \
  template void Aggregates<dim>::start_parts(std::int64_t, std::int64_t);     \
  template std::vector<std::uint8_t> Aggregates<dim>::pieces_to_link() const; \
  template void Aggregates<dim>::share_links();
STRAKE_INSTANTIATE(2)
STRAKE_INSTANTIATE(3)
#undef STRAKE_INSTANTIATE

}  // namespace strake::fluid
