#include "structure/body/size.hpp"
#include "structure/replay/replay.hpp"
#include "structure/solver/program.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {
      "replay",
      [](const Parameters& p) { return std::make_unique<Replay>(p, read_interface_record(p.replay_run)); },
      &surface_sizes};
}

}  // namespace strake::structure
