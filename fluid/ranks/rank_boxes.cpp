#include "fluid/ranks/rank_boxes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace strake::fluid {

namespace {

/// Boxes in a list, which are looked at one after the other.
constexpr std::size_t short_list = 4;

/// The boxes on both sides of a cut. A box that the cut goes through is on both.
struct Halves {
  double at = 0;
  int axis = -1;  // below 0: no cut
  std::vector<int> low, high;
  std::size_t larger() const { return std::max(low.size(), high.size()); }
};

/// The best of the cuts at the middle one of the boxes' lower bounds along each axis: that with the smallest
/// larger half.
Halves cut(std::span<const double> values, const std::vector<int>& ranks) {
  Halves best;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto lower = [&](int rank) { return values[6 * static_cast<std::size_t>(rank) + axis]; };
    const auto upper = [&](int rank) { return values[6 * static_cast<std::size_t>(rank) + 3 + axis]; };
    std::vector<double> bounds;
    for (const int rank : ranks) bounds.push_back(lower(rank));
    const auto middle = bounds.begin() + std::ssize(bounds) / 2;
    std::ranges::nth_element(bounds, middle);
    Halves halves{*middle, static_cast<int>(axis), {}, {}};
    for (const int rank : ranks) {
      if (lower(rank) < halves.at) halves.low.push_back(rank);
      if (upper(rank) > halves.at) halves.high.push_back(rank);
    }
    if (halves.larger() < ranks.size() && (best.axis < 0 || halves.larger() < best.larger()))
      best = std::move(halves);
  }
  return best;
}

}  // namespace

void RankBoxes::assign(std::span<const double> boxes) {
  values_.assign(boxes.begin(), boxes.end());
  nodes_.clear();
  list_.clear();
  std::vector<int> ranks(values_.size() / 6);
  std::iota(ranks.begin(), ranks.end(), 0);
  add(ranks);
}

/// Adds the node of these boxes and all behind it; returns its number.
std::int32_t RankBoxes::add(const std::vector<int>& ranks) {
  const auto number = static_cast<std::size_t>(std::ssize(nodes_));
  nodes_.emplace_back();
  const Halves halves = ranks.size() > short_list ? cut(values_, ranks) : Halves{};
  if (halves.axis < 0) {
    const auto begin = static_cast<std::int32_t>(list_.size());
    list_.insert(list_.end(), ranks.begin(), ranks.end());
    nodes_[number] = {0, -1, begin, static_cast<std::int32_t>(list_.size())};
  } else {
    const std::int32_t low = add(halves.low), high = add(halves.high);
    nodes_[number] = {halves.at, halves.axis, low, high};
  }
  return static_cast<std::int32_t>(number);
}

bool RankBoxes::owns(int rank, const Place& at) const {
  const std::span<const double> box = std::span(values_).subspan(6 * static_cast<std::size_t>(rank), 6);
  bool inside = true;
  for (std::size_t d = 0; d < 3; ++d) inside = inside && box[d] < at[d] && at[d] <= box[3 + d];
  return inside;
}

int RankBoxes::owner(const Place& at) const {
  if (nodes_.empty()) return 0;
  const Node* node = nodes_.data();
  while (node->axis >= 0) {
    const bool low = at[static_cast<std::size_t>(node->axis)] <= node->at;
    node = nodes_.data() + (low ? node->first : node->second);
  }
  for (std::int32_t k = node->first; k < node->second; ++k)
    if (const int rank = list_[static_cast<std::size_t>(k)]; owns(rank, at)) return rank;
  return 0;
}

}  // namespace strake::fluid
