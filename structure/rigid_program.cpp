#include "structure/program.hpp"
#include "structure/rigid.hpp"
#include "structure/size.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {"rigid", [](const Parameters& p) { return std::make_unique<Rigid>(p); }, &surface_sizes};
}

}  // namespace strake::structure
