#include "structure/body/size.hpp"
#include "structure/rigid/rigid.hpp"
#include "structure/solver/program.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"rigid", [](const Parameters& p) { return std::make_unique<Rigid>(p); }, &surface_sizes};
}

}  // namespace strake::structure
