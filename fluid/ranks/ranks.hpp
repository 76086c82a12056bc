#pragma once

#include "proto/ranks/communicator.hpp"

#include <functional>
#include <span>
#include <vector>

namespace strake::fluid {

/// Chooses the rank of each bucket. centres: 3×b [m]; weights: work of each; parts: number of ranks.
using Partition = std::function<std::vector<int>(std::span<const double> centres,
                                                 std::span<const double> weights, int parts)>;

/// The ranks of a run, and how the water is divided among them. By default there is one rank.
struct Ranks {
  Communicator* communicator = nullptr;
  Partition partition = {};
};

}  // namespace strake::fluid
