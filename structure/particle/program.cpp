#include "structure/program.hpp"

#include "structure/particle/solver.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"particle", [](const Parameters& p) { return std::make_unique<ParticleSolver>(p); }};
}

}  // namespace strake::structure
