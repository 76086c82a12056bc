#include "fluid/pressure_solver/grid_ranks.hpp"

#include <algorithm>
#include <stdexcept>

namespace strake::fluid {

namespace {

/// The pieces of the listed unknowns, ascending. Ranks that have the same cells list them in the same order.
template <int dim>
std::vector<std::int32_t> pieces_of(const Aggregates<dim>& pieces,
                                    const std::vector<std::int32_t>& unknowns) {
  std::vector<std::int32_t> list;
  for (const std::int32_t k : unknowns) {
    const std::int32_t piece = pieces.piece_of[static_cast<std::size_t>(k)];
    if (piece < 0) continue;  // a particle without neighbours
    if (list.empty() || list.back() != piece) list.push_back(piece);
  }
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

}  // namespace

template <int dim>
void GridRanks<dim>::number(const RankedUnknowns<dim>& unknowns, Aggregates<dim>& pieces) {
  communicator_ = unknowns.communicator;
  number_own(pieces);
  number_foreign(pieces, exchange_corners(unknowns, pieces));
  number_beyond(pieces, exchange_corners(unknowns, pieces));
  list_halo(pieces);
}

template <int dim>
void GridRanks<dim>::number_own(const Aggregates<dim>& pieces) {
  number_.assign(pieces.node_owner.size(), -1);
  own_nodes_.clear();
  for (std::size_t i = 0; i < number_.size(); ++i)
    if (pieces.node_owner[i] == communicator_->rank()) own_nodes_.push_back(static_cast<std::int32_t>(i));
  first_ = 0;
  const std::vector<std::int64_t> counts = communicator_->all(std::ssize(own_nodes_));
  for (int r = 0; r < communicator_->rank(); ++r) first_ += counts[static_cast<std::size_t>(r)];
  for (std::size_t k = 0; k < own_nodes_.size(); ++k)
    number_[static_cast<std::size_t>(own_nodes_[k])] = first_ + static_cast<std::int64_t>(k);
}

template <int dim>
std::vector<std::int64_t> GridRanks<dim>::exchange_corners(const RankedUnknowns<dim>& unknowns,
                                                           const Aggregates<dim>& pieces) {
  constexpr int corners = Aggregates<dim>::corners;
  const auto ranks = static_cast<std::size_t>(communicator_->size());
  std::vector<Bytes> to(ranks), from(ranks);
  std::vector<std::vector<std::int32_t>> copied(ranks);
  for (std::size_t r = 0; r < ranks; ++r) {
    for (const std::int32_t p : pieces_of(pieces, unknowns.halo->send[r]))
      for (int a = 0; a < corners; ++a) {
        const std::int32_t node =
            pieces.node[static_cast<std::size_t>(p) * corners + static_cast<std::size_t>(a)];
        append(to[r], node < 0 ? std::int64_t{-1} : number_[static_cast<std::size_t>(node)]);
      }
    copied[r] = pieces_of(pieces, unknowns.halo->receive[r]);
    from[r].resize(copied[r].size() * corners * sizeof(std::int64_t));
  }
  communicator_->exchange(to, from);
  std::vector<std::int64_t> corner(pieces.node.size(), -1);
  for (std::size_t r = 0; r < ranks; ++r) {
    const std::byte* at = from[r].data();
    for (const std::int32_t p : copied[r])
      for (std::size_t a = 0; a < corners; ++a)
        corner[static_cast<std::size_t>(p) * corners + a] = take<std::int64_t>(at);
  }
  return corner;
}

template <int dim>
void GridRanks<dim>::number_foreign(const Aggregates<dim>& pieces, const std::vector<std::int64_t>& corner) {
  for (std::size_t i = 0; i < pieces.node_owner.size(); ++i) {
    if (number_[i] >= 0) continue;
    const std::int32_t lowest = pieces.meeting[static_cast<std::size_t>(pieces.meeting_start[i])];
    number_[i] = corner[static_cast<std::size_t>(lowest)];
    if (number_[i] < 0) throw std::logic_error("ranks do not agree on the pressure's first grid");
  }
}

template <int dim>
void GridRanks<dim>::number_beyond(Aggregates<dim>& pieces, const std::vector<std::int64_t>& corner) {
  using Known = std::pair<std::int64_t, std::int32_t>;
  std::vector<Known> known;
  for (std::size_t i = 0; i < number_.size(); ++i)
    known.emplace_back(number_[i], static_cast<std::int32_t>(i));
  std::ranges::sort(known);
  std::vector<std::int64_t> beyond;
  const auto find = [&](std::int64_t number) {
    const auto found = std::ranges::lower_bound(known, number, {}, &Known::first);
    return found != known.end() && found->first == number ? found->second : std::int32_t{-1};
  };
  for (const std::int64_t number : corner)
    if (number >= 0 && find(number) < 0) beyond.push_back(number);
  std::ranges::sort(beyond);
  beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
  const auto rows = static_cast<std::int32_t>(number_.size());
  number_.insert(number_.end(), beyond.begin(), beyond.end());
  for (std::size_t c = 0; c < corner.size(); ++c) {
    if (corner[c] < 0) continue;
    const std::int32_t local = find(corner[c]);
    pieces.node[c] =
        local >= 0
            ? local
            : rows + static_cast<std::int32_t>(std::ranges::lower_bound(beyond, corner[c]) - beyond.begin());
  }
}

/// Lists the vertices around own pieces that other ranks own.
template <int dim>
void GridRanks<dim>::list_halo(const Aggregates<dim>& pieces) {
  nodes_.clear(communicator_->size());
  std::vector<Bytes> asked(nodes_.send.size());
  for (std::size_t i = 0; i < pieces.node_owner.size(); ++i) {
    const auto owner = static_cast<std::size_t>(pieces.node_owner[i]);
    if (pieces.node_owner[i] == communicator_->rank()) continue;
    nodes_.receive[owner].push_back(static_cast<std::int32_t>(i));
    append(asked[owner], number_[i]);
  }
  const std::vector<Bytes> wanted = communicator_->exchange_any(asked);
  for (std::size_t r = 0; r < wanted.size(); ++r)
    for (const std::int64_t number : values_of<std::int64_t>(wanted[r]))
      nodes_.send[r].push_back(own_nodes_.at(static_cast<std::size_t>(number - first_)));
}

template <int dim>
void GridRanks<dim>::build(const CoarseLevel<dim>& grid) {
  right_.resize(own_nodes_.size());
  solution_.resize(own_nodes_.size());
  solver_->build({.first = first_,
                  .own = std::ssize(own_nodes_),
                  .number = number_,
                  .start = grid.matrix.start,
                  .column = grid.matrix.column,
                  .value = grid.matrix.value,
                  .diagonal = grid.diagonal});
}

template <int dim>
void GridRanks<dim>::solve(CoarseLevel<dim>& grid) {
  nodes_.add_back(*communicator_, grid.right.data());
  for (std::size_t k = 0; k < own_nodes_.size(); ++k)
    right_[k] = grid.right[static_cast<std::size_t>(own_nodes_[k])];
  solver_->solve(right_, solution_);
  for (std::size_t k = 0; k < own_nodes_.size(); ++k)
    grid.solution[static_cast<std::size_t>(own_nodes_[k])] = solution_[k];
  nodes_.update(*communicator_, grid.solution.data());
}

template class GridRanks<2>;
template class GridRanks<3>;

}  // namespace strake::fluid
