#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/run/run_folder.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/lookup.hpp"
#include "proto/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace strake {
namespace {

/// Refuses a run whose body has no cells that a deck could be made of.
void refuse_without_cells(const std::filesystem::path& run,
                          const std::map<std::string, std::string>& values) {
  const auto refuse = [&](const std::string& what) {
    throw Error(
        ExitCode::case_file, run.string(),
        what + "; a deck is made of the cells of one structure.plate, structure.box or structure.mesh",
        "run a case with such a body and structure.solver = \"fem\", and export that run");
  };
  for (const auto& [key, value] : values) {
    if (key.starts_with("structures.")) refuse("has several bodies");
    for (const std::string shape : {"outline", "offsets", "wedge", "cylinder", "sphere"})
      if (key == "structure." + shape || key.starts_with("structure." + shape + "."))
        refuse(fmt::format("has a rigid body of structure.{}, which has no cells", shape));
  }
  if (at_or(values, "structure.solver") == "none") refuse("has no structure");
}

/// The refusal of a case that was read with finite elements in place of the run's own solver.
Error refused_as_cells(const std::filesystem::path& run, const std::string& solver, const Error& error) {
  return {error.code(), run.string(),
          fmt::format(
              "was run with structure.solver = \"{}\". With finite elements, which a deck is made of, its "
              "case is refused:\n{}",
              solver, error.problem()),
          "run the case with structure.solver = \"fem\", and export that run"};
}

}  // namespace

/// The run's body, supports and loads as an input file of another finite-element program. The program that
/// has the mesh writes it.
ExitCode export_run(const ExportOptions& options, const StopRequest& stop) {
  const std::filesystem::path& run = options.recorded;
  const std::filesystem::path case_file = run / "case.toml";
  std::error_code error;
  if (!std::filesystem::exists(case_file, error))
    throw Error(ExitCode::case_file, run.string(), "holds no case.toml",
                "name the folder of a run, e.g. runs/plate_entry");
  const auto values = flatten_toml(read_text(case_file).value_or(""), case_file.string());
  refuse_without_cells(run, values);
  const std::string name = std::filesystem::weakly_canonical(run, error).filename().string();
  const std::filesystem::path folder = options.folder.empty() ? run / "export" : options.folder;
  std::vector<std::string> sets = options.sets;
  const auto is_analysis = [](const std::string& set) { return set.starts_with("structure.analysis="); };
  if (std::ranges::any_of(sets, is_analysis))
    sets.insert(sets.begin(), "fluid.solver=none");   // of the body alone
  sets.insert(sets.begin(), "structure.solver=fem");  // whatever solver the run had
  try {
    fmt::print("{}",
               ask(find_program(program_name("structure", "fem")),
                   {"--export", options.to, "--run", run.string(), "--into", folder.string(), "--origin",
                    fmt::format("{}, strake {} ({})", name, strake_version(), strake_commit())},
                   case_file, sets, &stop));
  } catch (const Error& error) {
    const std::string solver = at_or(values, "structure.solver");
    if (error.code() != ExitCode::case_file || solver == "fem") throw;
    throw refused_as_cells(run, solver, error);
  }
  return ExitCode::done;
}

}  // namespace strake
