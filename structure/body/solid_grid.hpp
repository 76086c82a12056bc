#pragma once

#include "structure/body/solid.hpp"

namespace strake::structure {

/// Cells of the grid that the planes of all boxes make, of which their union has some. No integer: there may
/// be too many for one.
double grid_count(int dimension, const std::vector<SolidBox>&);

}  // namespace strake::structure
