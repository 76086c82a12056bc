#pragma once

#include "structure/body/size.hpp"

namespace strake::structure::fem {

/// Cells, the unknowns in their nodes, and the points of the interface, for each of which cells are searched.
SizeEstimates sizes(const Parameters&);

}  // namespace strake::structure::fem
