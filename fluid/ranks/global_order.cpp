#include "fluid/ranks/global_order.hpp"

#include <algorithm>

namespace strake::fluid {

namespace {

/// Number of keys that each rank gives to find the ranges.
constexpr std::size_t samples = 256;

struct Keyed {
  std::uint64_t key;
  std::int64_t place;
  auto operator<=>(const Keyed&) const = default;
};

/// Returns the first key of each rank's range but the first rank's.
std::vector<Keyed> first_of_ranges(Communicator& ranks, const std::vector<Keyed>& sorted) {
  Bytes own;
  const std::size_t count = std::min(samples, sorted.size());
  for (std::size_t k = 0; k < count; ++k) append(own, sorted[k * sorted.size() / count]);
  std::vector<Keyed> all, first;
  for (const Bytes& bytes : ranks.gather(own))
    for (const Keyed& sample : values_of<Keyed>(bytes)) all.push_back(sample);
  std::ranges::sort(all);
  const auto parts = static_cast<std::size_t>(ranks.size());
  for (std::size_t r = 1; r < parts && !all.empty(); ++r) first.push_back(all[r * all.size() / parts]);
  return first;
}

}  // namespace

std::vector<std::int64_t> places_by_key(Communicator& ranks, std::span<const std::uint64_t> key,
                                        std::span<const std::int64_t> old_place) {
  const auto parts = static_cast<std::size_t>(ranks.size());
  std::vector<Keyed> sorted(key.size());
  for (std::size_t k = 0; k < key.size(); ++k) sorted[k] = {key[k], old_place[k]};
  std::vector<Keyed> own = sorted;
  std::ranges::sort(sorted);
  const std::vector<Keyed> first = first_of_ranges(ranks, sorted);

  std::vector<Bytes> to(parts);
  std::vector<std::vector<std::size_t>> sent(parts);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const auto range = static_cast<std::size_t>(std::ranges::upper_bound(first, own[k]) - first.begin());
    append(to[range], own[k]);
    sent[range].push_back(k);
  }
  const std::vector<Bytes> arrived = ranks.exchange_any(to);
  std::vector<Keyed> range;
  for (const Bytes& bytes : arrived)
    for (const Keyed& one : values_of<Keyed>(bytes)) range.push_back(one);
  std::ranges::sort(range);
  std::int64_t before = 0;
  const std::vector<std::int64_t> counts = ranks.all(std::ssize(range));
  for (int r = 0; r < ranks.rank(); ++r) before += counts[static_cast<std::size_t>(r)];

  std::vector<Bytes> back(parts);
  for (std::size_t r = 0; r < parts; ++r)
    for (const Keyed& one : values_of<Keyed>(arrived[r]))
      append(back[r], before + (std::ranges::lower_bound(range, one) - range.begin()));
  const std::vector<Bytes> answers = ranks.exchange_any(back);
  std::vector<std::int64_t> place(own.size());
  for (std::size_t r = 0; r < parts; ++r) {
    const auto values = values_of<std::int64_t>(answers[r]);
    for (std::size_t k = 0; k < values.size(); ++k) place[sent[r][k]] = values[k];
  }
  return place;
}

}  // namespace strake::fluid
