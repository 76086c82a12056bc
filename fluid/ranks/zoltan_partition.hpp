#pragma once

#include "proto/ranks/communicator.hpp"

#include <span>
#include <vector>

namespace strake::fluid {

/// Divides the buckets of all processes by recursive coordinate bisection of Zoltan, into boxes of equal
/// work; a Partition.
std::vector<double> zoltan_partition(Communicator& ranks, std::span<const double> centres,
                                     std::span<const double> weights);

}  // namespace strake::fluid
