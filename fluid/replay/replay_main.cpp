#include "coupler/participant/participant_main.hpp"
#include "fluid/case/replay_keys.hpp"
#include "fluid/replay/replay.hpp"
#include "proto/version.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

// strake-fluid-replay: applies the recorded fluid force of an earlier run to the structure.
int main(int argc, char** argv) {
  using namespace strake;
  fluid::ReplayedRun run;

  Program program;
  program.program = "strake-fluid-replay";
  program.solver = "replay";
  program.version = strake_version();
  program.built_from = build_text();
  program.prefix = "fluid";
  program.declare = [&](CaseFile& file) { run = fluid::read_replayed_run(file); };
  program.check = [&](CaseFile&) {
    const InterfaceRecord record = read_interface_record(run.folder);
    require_end(record, run.end_time, run.folder.string());
    return std::vector<std::string>{
        fmt::format("replay of {}, to {:.6g} s", run.folder.string(), record.end())};
  };
  program.build = [&](CaseFile&, const ParticipantOptions&, const Setup& setup) {
    InterfaceRecord record = read_interface_record(run.folder);
    require_end(record, run.end_time, run.folder.string());
    return std::make_unique<fluid::Replay>(std::move(record), run.folder, setup);
  };
  return participant_main(argc, argv, program);
}
