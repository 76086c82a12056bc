#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/version.hpp"

#include <fmt/format.h>

namespace strake {

/// The run's body, supports and loads as an input file of another finite-element program. The program that
/// has the mesh writes it.
ExitCode export_run(const ExportOptions& options, const StopRequest& stop) {
  const std::filesystem::path& run = options.recorded;
  const std::filesystem::path case_file = run / "case.toml";
  std::error_code error;
  if (!std::filesystem::exists(case_file, error))
    throw Error(ExitCode::case_file, run.string(), "holds no case.toml",
                "name the folder of a run, e.g. runs/plate_entry");
  const std::string name = std::filesystem::weakly_canonical(run, error).filename().string();
  const std::filesystem::path folder = options.folder.empty() ? run / "export" : options.folder;
  std::vector<std::string> sets = options.sets;
  sets.insert(sets.begin(), "structure.solver=fem");  // whatever solver the run had
  fmt::print("{}", ask(find_program(program_name("structure", "fem")),
                       {"--export", options.to, "--run", run.string(), "--into", folder.string(), "--origin",
                        fmt::format("{}, strake {} ({})", name, strake_version(), strake_commit())},
                       case_file, sets, &stop));
  return ExitCode::done;
}

}  // namespace strake
