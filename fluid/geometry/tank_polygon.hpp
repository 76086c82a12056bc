#pragma once

#include "fluid/parameters/parameters.hpp"

#include <string>

namespace strake::fluid {

/// Returns the reason why a polygon cannot be a tank; empty where it can. Refused are a clockwise order,
/// edges that cross, a corner too sharp, an edge too short for the dummy particles, and a wall so thin that
/// the water on both sides would be within `reach` [m].
std::string polygon_fault(const Parameters&, double reach);

}  // namespace strake::fluid
