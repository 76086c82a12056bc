#pragma once

#include "structure/body/solid.hpp"

namespace strake::structure::fem {

/// A solid made of boxes with its cells cut for finite elements, conforming: 2^refinement cells through the
/// thickness of each part; along its length and width the cells grow away from supports and from planes where
/// parts meet, since the stress is singular in corners. A solid from a mesh file has the cells of the file.
Solid refined(const Solid&, int refinement);
/// How many cells that has, without making them.
double refined_count(const Solid&, int refinement);

}  // namespace strake::structure::fem
