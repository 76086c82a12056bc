#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "coupler/case_view.hpp"
#include "coupler/commands.hpp"
#include "coupler/interface_record.hpp"
#include "coupler/launch.hpp"
#include "coupler/run_folder.hpp"
#include "proto/result_file.hpp"
#include "structure/deck/deck.hpp"

namespace strake {

namespace {

/// The finite-element model of a case, from the program that has the mesh.
structure::deck::Model model_of(const std::filesystem::path& case_file, std::vector<std::string> sets,
                                const StopRequest& stop) {
  sets.insert(sets.begin(), "structure.solver=fem");  // whatever solver the run had
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "model.h5";
  ask(find_program(program_name("structure", "fem")), {"--export", file.string()}, case_file, sets, &stop);
  return structure::deck::from_archive(read_archive(file), file.string());
}

void require_same_points(const Points& recorded, const Points& wanted, const std::filesystem::path& run) {
  const double size = (wanted.rowwise().maxCoeff() - wanted.rowwise().minCoeff()).norm();
  if (recorded.cols() == wanted.cols() && (recorded - wanted).cwiseAbs().maxCoeff() <= 1e-9 * size) return;
  throw Error(
      ExitCode::case_file, (run / "interface").string(),
      fmt::format(
          "was recorded on {} interface points, the finite elements of its case have {}, or at other places",
          recorded.cols(), wanted.cols()),
      "a run with surface coupling; no --set that changes the shape");
}

std::optional<structure::deck::LoadHistory> load_of(const std::filesystem::path& run,
                                                    const structure::deck::Model& model) {
  std::error_code none;
  if (!std::filesystem::exists(run / "interface", none)) {
    if (model.analysis != structure::Analysis::dynamic) return std::nullopt;
    throw Error(ExitCode::case_file, run.string(), "has no interface/, so no recorded load",
                "name the folder of a coupled run, or one with structure.analysis = \"static\" or \"modal\"");
  }
  const InterfaceRecord record = read_interface_record(run);
  require_same_points(record.mesh.position, model.interface_position, run);
  return structure::deck::nodal_history(model, record.windows, record.force);
}

}  // namespace

/// The run's body, supports and loads as an input file of another finite-element program.
ExitCode export_run(const ExportOptions& options, const StopRequest& stop) {
  const std::filesystem::path& run = options.recorded;
  const std::filesystem::path case_file = run / "case.toml";
  std::error_code error;
  if (!std::filesystem::exists(case_file, error))
    throw Error(ExitCode::case_file, run.string(), "holds no case.toml",
                "name the folder of a run, e.g. runs/plate_entry");
  const structure::deck::Model model = model_of(case_file, options.sets, stop);
  const std::optional<structure::deck::LoadHistory> load = load_of(run, model);

  CaseFile file = CaseFile::load(case_file);
  const std::string title = read_common(file).title,
                    name = std::filesystem::weakly_canonical(run, error).filename().string();
  const structure::deck::Story story{
      .title = title.empty() ? name : title,
      .origin = fmt::format("{}, strake {} ({})", name, strake_version(), strake_commit())};
  const bool calculix = options.to == "ccx";
  const std::filesystem::path folder = options.folder.empty() ? run / "export" : options.folder;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ExitCode::cannot_write, folder.string(), error.message());
  const std::filesystem::path deck = folder / (calculix ? "ccx.inp" : "ansys.inp");
  write_text(deck, calculix ? structure::deck::calculix(model, load, story)
                            : structure::deck::ansys(model, load, story));
  write_text(folder / "probes.csv", structure::deck::probe_table(model));

  fmt::print("{}   {} nodes, {} elements, {} held unknowns\n", deck.string(), model.n_nodes(),
             model.n_cells(), model.fixed.size());
  if (load)
    fmt::print("  load    {} windows to {:.6g} s on {} unknowns, largest {:.4g} N{}\n", load->time.size() - 1,
               load->end(), load->unknown.size(), load->largest, model.dimension == 2 ? "/m" : "");
  fmt::print("  frame   that of the supports; displacements are deflections\n");
  fmt::print("  probes  {}\n", (folder / "probes.csv").string());
  if (calculix)
    fmt::print("  next    cd {} && ccx -i ccx   (Debian package calculix-ccx), displacements in ccx.dat\n",
               folder.string());
  else
    fmt::print("  next    in Ansys Mechanical APDL: /INPUT,ansys,inp   (not run by Strake's tests)\n");
  return ExitCode::done;
}

}  // namespace strake
