#include "structure/program.hpp"
#include "structure/rigid.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"rigid", [](const Parameters& p) { return std::make_unique<Rigid>(p); }};
}

}  // namespace strake::structure
