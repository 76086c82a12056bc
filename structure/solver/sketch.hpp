#pragma once

#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <string>

namespace strake::structure {

/// Draws what a solver made of the case's shape, as SVG. It shows parts, cells or particles, supports, and
/// the loaded surface with its points. Solids of three dimensions are drawn in oblique projection, by the
/// edges of their parts.
std::string picture(const Solver&, const Parameters&);

}  // namespace strake::structure
