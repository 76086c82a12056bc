#pragma once

#include "structure/solver/solver.hpp"

#include <string>

namespace strake::structure {

/// One line of the table that `strake check` prints; empty for a solver without properties.
std::string properties_line(const std::string& kind, const Properties&);

}  // namespace strake::structure
