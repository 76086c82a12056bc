#pragma once

#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <string>

namespace strake::structure {

/// A drawing of what a solver made of the case's shape, as SVG: parts, cells or particles, supports, wet
/// surface with its points. Solids of three dimensions are drawn in oblique projection, by the edges of their
/// parts.
std::string picture(const Solver&, const Parameters&);

}  // namespace strake::structure
