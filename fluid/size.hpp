#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/size_limit.hpp"

#include <cstdint>

namespace strake::fluid {

/// Estimates the particles of each kind, and the places of the tank's lattice.
SizeEstimates sizes(const Parameters&);

/// What one of several ranks holds, at the worst.
struct RankSize {
  double ghosts = 0;          // over its own water particles
  double bytes = 0;           // of its particles, neighbours and equation
  double bytes_of_first = 0;  // the same of the first rank while it counts voids
};

/// Estimates it from the box of the water, cut into equal halves along its longest side again and again. The
/// ghosts are the water within two buckets of a part. water, layers: particles of the whole.
RankSize rank_size(const Parameters&, std::int64_t water, std::int64_t layers);

}  // namespace strake::fluid
