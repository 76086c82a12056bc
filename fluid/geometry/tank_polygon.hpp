#pragma once

#include "fluid/parameters/parameters.hpp"

#include <string>

namespace strake::fluid {

/// Why that polygon can be no tank: a clockwise walk, edges that cross, a corner too sharp, an edge too short
/// for rows of particles, or a wall so thin that the water on both sides would meet within `reach` [m].
/// Empty: it can.
std::string polygon_fault(const Parameters&, double reach);

}  // namespace strake::fluid
