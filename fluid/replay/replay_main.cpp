#include "coupler/participant/participant_main.hpp"
#include "fluid/case/replay_keys.hpp"
#include "fluid/replay/replay.hpp"
#include "proto/version.hpp"

#include <memory>

// strake-fluid-replay: applies the recorded fluid force of an earlier run to the structure.
int main(int argc, char** argv) {
  using namespace strake;
  std::filesystem::path run;

  Program program;
  program.program = "strake-fluid-replay";
  program.solver = "replay";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "fluid";
  program.declare = [&](CaseFile& file) { run = fluid::read_replayed_run(file); };
  program.check = [&](CaseFile&) {
    return std::vector<std::string>{"replay of " + run.string() + ", to " +
                                    std::to_string(read_interface_record(run).end()) + " s"};
  };
  program.build = [&](CaseFile&, const ParticipantOptions&, const Setup& setup) {
    return std::make_unique<fluid::Replay>(read_interface_record(run), run, setup);
  };
  return participant_main(argc, argv, program);
}
