#pragma once

#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <memory>

namespace strake::structure::fem {

/// The finite-element solver for a case, behind its interface: who uses it compiles nothing of it.
std::unique_ptr<Solver> make_solver(const Parameters&);

}  // namespace strake::structure::fem
