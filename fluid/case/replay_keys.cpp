#include "fluid/case/replay_keys.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

#include <string>

namespace strake::fluid {

ReplayedRun read_replayed_run(CaseFile& file) {
  const double end_time = read_common(file).end_time;
  CaseTable fluid = file.root().table("fluid"), replay = fluid.table("replay", "fluid.solver = replay");
  std::string folder;
  replay.text("run", folder,
              {.path = true, .help = "run folder whose recorded interface force is played back"});
  if (folder.empty() && !file.only_declares())
    throw replay.error("run", "the folder of a run with interface/*.h5",
                       "fluid.replay.run = \"runs/plate_entry\"");
  fluid.accept_all();  // the water itself is not computed: its keys are the other program's
  return {folder, end_time};
}

}  // namespace strake::fluid
