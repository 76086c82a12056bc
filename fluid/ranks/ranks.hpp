#pragma once

#include "fluid/ranks/shared_grid.hpp"
#include "proto/ranks/communicator.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace strake::fluid {

/// Returns the first entry of a rank's share where so many entries are divided evenly, in their order; of a
/// rank behind the last one, their number.
inline std::int64_t begin_of_share(std::int64_t entries, std::int64_t ranks, std::int64_t rank) {
  return entries / ranks * rank + entries % ranks * rank / ranks;
}

/// Divides space into one box per rank, by the work in it. centres: 3×b, of the own buckets of this rank;
/// weights: work of each. Returns six numbers per rank, the lower and the upper corner of its box. The boxes
/// fill all space and do not overlap. All ranks call it together and get the same boxes.
using Partition = std::function<std::vector<double>(Communicator&, std::span<const double> centres,
                                                    std::span<const double> weights)>;

/// The ranks of a run, how the water is divided among them, and who solves the pressure's first grid. By
/// default there is one rank.
struct Ranks {
  Communicator* communicator = nullptr;
  Partition partition = {};
  /// Makes the solver of the grid's equation. Where it is empty, the first rank solves the whole pressure
  /// equation as on one rank: to the last bit, but no faster.
  std::function<std::unique_ptr<SharedGrid>()> shared_grid = {};
};

}  // namespace strake::fluid
