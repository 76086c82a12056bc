#include "structure/program.hpp"

#include "structure/fem/make_solver.hpp"
#include "structure/fem/model.hpp"
#include "structure/fem/size.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"fem", [](const Parameters& p) { return fem::make_solver(p); }, &fem::sizes, 1, &fem::model};
}

}  // namespace strake::structure
