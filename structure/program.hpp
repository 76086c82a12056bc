#pragma once

#include "structure/parameters.hpp"
#include "structure/solver.hpp"

#include <functional>
#include <memory>
#include <string>

namespace strake::structure {

/// What tells one structure program from another. main.cpp is the same in all of them; each links the one
/// file that defines `this_program`.
struct SolverProgram {
  std::string kind;  // "fem" | "particle" | "rigid" | "replay"
  std::function<std::unique_ptr<Solver>(const Parameters&)> build;
};
SolverProgram this_program();

}  // namespace strake::structure
