#pragma once

#include <span>
#include <vector>

namespace strake::fluid {

/// Divides buckets by recursive coordinate bisection of Zoltan, into parts of equal work. All ranks get the
/// same answer: each computes it by itself.
std::vector<int> zoltan_partition(std::span<const double> centres, std::span<const double> weights,
                                  int parts);

}  // namespace strake::fluid
