#include "coupler/participant_main.hpp"
#include "fluid/replay.hpp"
#include "proto/case_keys.hpp"

#include <memory>

// strake-fluid-replay: the fluid of an earlier run, as far as the structure felt it.
int main(int argc, char** argv) {
  using namespace strake;
  std::filesystem::path run;

  Program program;
  program.program = "strake-fluid-replay";
  program.solver = "replay";
  program.version = STRAKE_VERSION;
  program.prefix = "fluid";
  program.declare = [&](CaseFile& file) {
    read_common(file);
    CaseTable fluid = file.root().table("fluid"), replay = fluid.table("replay", "fluid.solver = replay");
    std::string folder;
    replay.text("run", folder, {.help = "run folder whose recorded interface force is played back"});
    if (folder.empty() && !file.only_declares())
      throw replay.error("run", "the folder of a run with interface/*.h5",
                         "fluid.replay.run = \"runs/plate_entry\"");
    run = file.folder() / folder;  // an absolute path stays itself
    fluid.accept_all();            // the water itself is not computed: its keys are the other program's
  };
  program.check = [&](CaseFile&) {
    return std::vector<std::string>{"replay of " + run.string() + ", to " +
                                    std::to_string(read_interface_record(run).end()) + " s"};
  };
  program.build = [&](CaseFile&, const ParticipantOptions&, const Setup& setup) {
    return std::make_unique<fluid::Replay>(read_interface_record(run), run, setup);
  };
  return participant_main(argc, argv, program);
}
