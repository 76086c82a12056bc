#pragma once

#include "structure/body/solid.hpp"

namespace strake::structure::fem {

/// Divides a solid made of boxes into a conforming mesh of finite elements. Each part has 2^refinement cells
/// through its thickness. Along its length and width the cells grow away from supports and from planes where
/// parts meet, since the stress is singular in corners. A solid from a mesh file keeps the cells of the file.
Solid refined(const Solid&, int refinement);
/// How many cells that has, without making them.
double refined_count(const Solid&, int refinement);

}  // namespace strake::structure::fem
