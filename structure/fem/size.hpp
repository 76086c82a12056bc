#pragma once

#include "structure/body/size.hpp"

namespace strake::structure::fem {

/// Cells, the unknowns in their nodes, and the points of the interface, which are looked for in the cells.
SizeEstimates sizes(const Parameters&);

}  // namespace strake::structure::fem
