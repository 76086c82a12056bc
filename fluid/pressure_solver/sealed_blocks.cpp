#include "fluid/pressure_solver/sealed_blocks.hpp"

#include <algorithm>
#include <map>

namespace strake::fluid {

namespace {

/// The connected parts of one rank's own unknowns. A part with a row that P = 0 or compressibility determines
/// is held.
struct Parts {
  std::vector<std::int32_t> part_of;  // of each own unknown; −1: a copy
  std::vector<std::uint8_t> held;     // of each part
};

/// Whether an unknown is own: the rows of copies are empty.
bool is_own(const PressureSystem& system, std::size_t k) {
  return system.diagonal.data()[k] != 0;
}

/// Whether P = 0 beside it or compressibility makes the diagonal of a row larger than its sum; round-off does
/// not.
bool is_determined(const PressureSystem& system, std::int64_t k) {
  double sum = 0;
  const auto row = static_cast<std::size_t>(k);
  for (std::int64_t e = system.start[row]; e < system.stop[row]; ++e) sum -= system.value.data()[e];
  return system.diagonal[k] - sum > 1e-10 * system.diagonal[k];
}

Parts connected_parts(const PressureSystem& system) {
  const auto n = static_cast<std::size_t>(system.size());
  Parts parts{std::vector<std::int32_t>(n, -1), {}};
  std::vector<std::int64_t> reached;
  for (std::size_t seed = 0; seed < n; ++seed) {
    if (parts.part_of[seed] >= 0 || !is_own(system, seed)) continue;
    const auto part = static_cast<std::int32_t>(parts.held.size());
    bool held = false;
    reached.assign(1, static_cast<std::int64_t>(seed));
    parts.part_of[seed] = part;
    for (std::size_t at = 0; at < reached.size(); ++at) {
      const auto k = static_cast<std::size_t>(reached[at]);
      held = held || is_determined(system, reached[at]);
      for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
        const auto j = static_cast<std::size_t>(system.column.data()[e]);
        if (parts.part_of[j] >= 0 || !is_own(system, j)) continue;
        parts.part_of[j] = part;
        reached.push_back(static_cast<std::int64_t>(j));
      }
    }
    parts.held.push_back(held ? 1 : 0);
  }
  return parts;
}

/// What a rank tells of one of its parts. Its links follow: numbers of parts of other ranks.
struct PartHead {
  std::int64_t number, rows, first_place, links;
  double sum;  // of the right side
  std::int8_t held;
};

/// A set of connected parts of all ranks.
struct Block {
  std::int64_t rows = 0, first_place = -1;
  double sum = 0;
  bool held = false;
};

/// Joins the parts of all ranks to blocks: the block of each part.
std::map<std::int64_t, Block> joined(const std::vector<Bytes>& all,
                                     std::map<std::int64_t, std::int64_t>& root) {
  std::vector<std::pair<PartHead, std::vector<std::int64_t>>> parts;
  for (const Bytes& bytes : all)
    for (const std::byte* at = bytes.data(); at < bytes.data() + bytes.size();) {
      auto& [head, links] = parts.emplace_back();
      head = take<PartHead>(at);
      for (std::int64_t k = 0; k < head.links; ++k) links.push_back(take<std::int64_t>(at));
      root[head.number] = head.number;
    }
  const auto find = [&](std::int64_t number) {
    while (root.at(number) != number) number = root.at(number) = root.at(root.at(number));
    return number;
  };
  for (const auto& [head, links] : parts)
    for (const std::int64_t other : links) {
      const std::int64_t a = find(head.number), b = find(other);
      root.at(std::max(a, b)) = std::min(a, b);
    }
  std::map<std::int64_t, Block> blocks;
  for (const auto& [head, links] : parts) {
    Block& block = blocks[root.at(head.number) = find(head.number)];
    if (block.first_place < 0 || head.first_place < block.first_place) block.first_place = head.first_place;
    block.rows += head.rows;
    block.sum += head.sum;
    block.held = block.held || head.held != 0;
  }
  return blocks;
}

}  // namespace

/// Describes each part: its rows, and the parts of other ranks that they reach. number: of the part of each
/// unknown, copies included.
static Bytes described(const PressureSystem& system, const Parts& parts, std::span<const std::int64_t> number,
                       std::span<const std::int64_t> place) {
  std::vector<PartHead> heads(parts.held.size());
  std::vector<std::vector<std::int64_t>> links(heads.size());
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (parts.part_of[k] < 0) continue;
    const auto p = static_cast<std::size_t>(parts.part_of[k]);
    PartHead& head = heads[p];
    if (head.rows == 0) head = {number[k], 0, place[k], 0, 0, static_cast<std::int8_t>(parts.held[p])};
    ++head.rows;
    head.first_place = std::min(head.first_place, place[k]);
    head.sum += system.right[static_cast<Eigen::Index>(k)];
    for (std::int64_t e = system.start[k]; e < system.stop[k]; ++e) {
      const std::int64_t other = number[static_cast<std::size_t>(system.column.data()[e])];
      if (other != number[k] && (links[p].empty() || links[p].back() != other)) links[p].push_back(other);
    }
  }
  Bytes told;
  for (std::size_t p = 0; p < heads.size(); ++p) {
    std::ranges::sort(links[p]);
    links[p].erase(std::unique(links[p].begin(), links[p].end()), links[p].end());
    heads[p].links = std::ssize(links[p]);
    append(told, heads[p]);
    for (const std::int64_t other : links[p]) append(told, other);
  }
  return told;
}

template <int dim>
int close_sealed_blocks(PressureSystem& system, const RankedUnknowns<dim>& unknowns) {
  Communicator& communicator = *unknowns.communicator;
  const std::span<const std::int64_t> place = unknowns.place;
  const Parts parts = connected_parts(system);
  if (!communicator.any(std::ranges::count(parts.held, 0) > 0)) return 0;

  const std::vector<std::int64_t> counts = communicator.all(std::ssize(parts.held));
  std::int64_t first = 0;
  for (int r = 0; r < communicator.rank(); ++r) first += counts[static_cast<std::size_t>(r)];
  std::vector<std::int64_t> number(parts.part_of.size(), -1);
  for (std::size_t k = 0; k < number.size(); ++k)
    if (parts.part_of[k] >= 0) number[k] = first + parts.part_of[k];
  unknowns.halo->update(communicator, number.data());

  std::map<std::int64_t, std::int64_t> root;
  const std::map<std::int64_t, Block> blocks =
      joined(communicator.gather(described(system, parts, number, place)), root);
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (parts.part_of[k] < 0) continue;
    const Block& block = blocks.at(root.at(number[k]));
    if (block.held) continue;
    system.right[static_cast<Eigen::Index>(k)] -= block.sum / static_cast<double>(block.rows);
    if (place[k] == block.first_place) system.diagonal[static_cast<Eigen::Index>(k)] *= 2;
  }
  return static_cast<int>(std::ranges::count_if(blocks, [](const auto& of) { return !of.second.held; }));
}

template int close_sealed_blocks<2>(PressureSystem&, const RankedUnknowns<2>&);
template int close_sealed_blocks<3>(PressureSystem&, const RankedUnknowns<3>&);

}  // namespace strake::fluid
