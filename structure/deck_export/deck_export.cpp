#include "structure/deck_export/deck_export.hpp"

#include "coupler/participant/interface_record.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "structure/deck/deck.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

namespace strake::structure {
namespace {

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

/// The load on the structure: of the water, and of what is attached to it.
std::vector<Points> with_attachments(const InterfaceRecord& record) {
  std::vector<Points> load = record.force;
  const auto attached = record.other.find("attachments.force");
  if (attached != record.other.end())
    for (std::size_t w = 0; w < load.size(); ++w) load[w] += attached->second.value.at(w);
  return load;
}

std::optional<deck::LoadHistory> load_of(const std::filesystem::path& run, const deck::Model& model) {
  if (model.analysis != Analysis::dynamic) return std::nullopt;
  std::error_code none;
  if (!std::filesystem::exists(run / "interface", none))
    throw Error(ExitCode::case_file, run.string(), "has no interface/, so no recorded load",
                "name the folder of a coupled run, or one with structure.analysis = \"static\" or \"modal\"");
  const InterfaceRecord record = read_interface_record(run);
  require_same_points(record.mesh.position, model.interface_position, run);
  return deck::nodal_history(model, record.windows, with_attachments(record));
}

}  // namespace

std::string export_deck(const deck::Model& model, const std::string& title, const DeckRequest& wanted) {
  const std::optional<deck::LoadHistory> load = load_of(wanted.run, model);
  std::error_code error;
  const deck::Story story{
      .title =
          title.empty() ? std::filesystem::weakly_canonical(wanted.run, error).filename().string() : title,
      .origin = wanted.origin};
  const bool calculix = wanted.format == "ccx";
  std::filesystem::create_directories(wanted.folder, error);
  if (error) throw Error(ExitCode::cannot_write, wanted.folder.string(), error.message());
  const std::filesystem::path file = wanted.folder / (calculix ? "ccx.inp" : "ansys.inp");
  write_text(file, calculix ? deck::calculix(model, load, story) : deck::ansys(model, load, story));
  write_text(wanted.folder / "probes.csv", deck::probe_table(model));

  std::string told = fmt::format("{}   {} nodes, {} elements, {} held unknowns\n", file.string(),
                                 model.n_nodes(), model.n_cells(), model.fixed.size());
  if (load)
    told += fmt::format("  load    {} windows to {:.6g} s on {} unknowns, largest {:.4g} N{}\n",
                        load->time.size() - 1, load->end(), load->unknown.size(), load->largest,
                        model.dimension == 2 ? "/m" : "");
  told += "  frame   that of the supports; displacements are deflections\n";
  told += fmt::format("  probes  {}\n", (wanted.folder / "probes.csv").string());
  told +=
      calculix
          ? fmt::format(
                "  next    cd {} && ccx -i ccx   (Debian package calculix-ccx), displacements in ccx.dat\n",
                wanted.folder.string())
          : "  next    in Ansys Mechanical APDL: /INPUT,ansys,inp   (not run by Strake's tests)\n";
  return told;
}

}  // namespace strake::structure
