#include "structure/program.hpp"
#include "structure/replay.hpp"
#include "structure/size.hpp"

namespace strake::structure {

SolverProgram this_program() {
  return {
      "replay",
      [](const Parameters& p) { return std::make_unique<Replay>(p, read_interface_record(p.replay_run)); },
      &surface_sizes};
}

}  // namespace strake::structure
