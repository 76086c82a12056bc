#include "coupler/case/case_queries.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/participant/stop_request.hpp"

namespace strake {

namespace {

/// The side that the record replaces. It is the requested one, else the structure if the case has none, else
/// the fluid, so that recorded loads act on another structure.
std::string playing_side(const ReplayOptions& options, const CommonKeys& keys) {
  if (!options.side.empty()) return options.side;
  return keys.structure_solver == "none" ? "structure" : "fluid";
}

}  // namespace

ExitCode replay(const ReplayOptions& options, const StopRequest& stop) {
  std::error_code none;
  if (!std::filesystem::exists(options.recorded / "interface", none))
    throw Error(ExitCode::case_file, options.recorded.string(), "has no interface/ to play back",
                "name the folder of a coupled run");
  const CommonKeys keys = common_keys_of(options.run.case_file, options.run.sets);
  const std::string side = playing_side(options, keys);
  std::vector<std::string> tables;  // of several bodies each plays its own part
  if (side == "structure")
    for (const BodyKeys& body : keys.bodies) tables.push_back("structures." + body.name);
  if (tables.empty()) tables = {side};
  RunOptions run_options = options.run;
  for (const std::string& table : tables) {
    run_options.sets.push_back(table + ".solver=replay");
    run_options.sets.push_back(
        table + ".replay.run=" + std::filesystem::absolute(options.recorded).lexically_normal().string());
  }
  // A recorded motion follows no force: what is attached to the structure has nothing to do.
  if (side == "structure" && !given_among({"attachments"}, options.run.case_file, options.run.sets).empty())
    run_options.sets.push_back("attachments=[]");
  if (run_options.folder.tag.empty()) run_options.folder.tag = "replay";
  return run(run_options, stop);
}

}  // namespace strake
