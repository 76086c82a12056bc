#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/size_limit.hpp"

namespace strake::fluid {

/// Estimates the particles of each kind, and the places of the tank's lattice.
SizeEstimates sizes(const Parameters&);

}  // namespace strake::fluid
