#include "structure/program.hpp"

#include "structure/fem/make_solver.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"fem", [](const Parameters& p) { return fem::make_solver(p); }};
}

}  // namespace strake::structure
