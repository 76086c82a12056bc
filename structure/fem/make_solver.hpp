#pragma once

#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <memory>

namespace strake::structure::fem {

/// Makes the finite-element solver of a case, behind its interface, so that callers compile nothing of it.
std::unique_ptr<Solver> make_solver(const Parameters&);

}  // namespace strake::structure::fem
