#include "structure/body/size.hpp"
#include "structure/replay/replay.hpp"
#include "structure/solver/program.hpp"

#include <utility>

namespace strake::structure {

SolverProgram this_program() {
  return {"replay",
          [](const Parameters& p) {
            InterfaceRecord record = read_interface_record(p.replay_run);
            if (!p.body_name.empty()) record = record.of_body(p.body_name, p.replay_run.string());
            return std::make_unique<Replay>(p, std::move(record));
          },
          &surface_sizes};
}

}  // namespace strake::structure
