#include "coupler/case/rank_threads.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string_view>

namespace strake {
namespace {

/// Whether a launcher starts its ranks on this machine alone: mpirun, without hosts of its own or of a batch
/// system.
bool stays_here(const std::string& launcher) {
  constexpr std::array variables{"SLURM_JOB_ID", "PBS_NODEFILE", "LSB_HOSTS", "PE_HOSTFILE",
                                 "OMPI_MCA_orte_default_hostfile"};
  if (std::ranges::any_of(variables, [](const char* name) { return std::getenv(name) != nullptr; }))
    return false;
  std::istringstream text(launcher);
  std::string program;
  text >> program;
  const std::filesystem::path name = std::filesystem::path(program).filename();
  if (name != "mpirun" && name != "mpiexec") return false;
  for (std::string word; text >> word;)
    if (word == "-H" || word == "-f" || word.find("host") != std::string::npos ||
        word.find("machinefile") != std::string::npos)
      return false;
  return true;
}

/// Whether the ranks of a side divide the processors of machines that only they know.
bool divides_elsewhere(const CaseView& view, const SideView& side) {
  return ranks_of(view, side) > 1 && !view.common.threads_given &&
         !stays_here(at_or(view.value, table_of(side) + ".launcher"));
}

}  // namespace

std::string table_of(const SideView& side) {
  return side.is_body ? "structures." + side.side : side.side;
}

int ranks_of(const CaseView& view, const SideView& side) {
  return static_cast<int>(view.number(table_of(side) + ".ranks").value_or(1));
}

int threads_of(const CaseView& view, const SideView& side) {
  const int ranks = ranks_of(view, side);
  return ranks > 1 ? threads_of_rank(view.common, ranks, processors_here()) : view.common.threads;
}

int most_threads_of(const CaseView& view) {
  int most = 1;
  for (const SideView* side : view.sides()) most = std::max(most, threads_of(view, *side));
  return most;
}

Json record_of(const CaseView& view, const SideView& side) {
  Json record = {{"solver", side.solver}, {"program", side.program.string()}};
  if (ranks_of(view, side) > 1) record["ranks"] = ranks_of(view, side);
  if (!divides_elsewhere(view, side)) record["threads"] = threads_of(view, side);
  return record;
}

void say_shares(CaseView& view) {
  if (view.common.threads_given) return;
  std::string shares;
  for (const SideView* side : view.sides()) {
    if (ranks_of(view, *side) == 1) continue;
    const std::string own = divides_elsewhere(view, *side) ? "a share of the processors of its machine"
                                                           : fmt::format("{}", threads_of(view, *side));
    shares += fmt::format(", {} for each of the {} ranks of {}", own, ranks_of(view, *side), side->side);
  }
  const std::string line = fmt::format("\nthreads = {}  # default\n", view.common.threads);
  const std::size_t at = view.resolved.find("[run]" + line);
  if (shares.empty() || at == std::string::npos) return;
  view.resolved.replace(
      at + std::string_view("[run]").size(), line.size(),
      fmt::format("\n# threads is not given: {} for a solver{}\n", view.common.threads, shares));
}

std::vector<std::string> crowd_lines(const CaseView& view, int processors) {
  std::vector<std::string> lines;
  if (processors == 0) processors = processors_here();
  for (const SideView* side : view.sides()) {
    const int ranks = ranks_of(view, *side), threads = threads_of_rank(view.common, ranks, processors);
    if (ranks == 1 || ranks * threads <= processors) continue;
    if (!stays_here(at_or(view.value, table_of(*side) + ".launcher"))) continue;
    const int share = std::max(1, processors / ranks);
    lines.push_back(fmt::format("{}: {} ranks of {} thread{} take turns on {} processor{}: --set {}",
                                side->side, ranks, threads, threads == 1 ? "" : "s", processors,
                                processors == 1 ? "" : "s",
                                threads > share ? fmt::format("run.threads={}", share)
                                                : fmt::format("{}.ranks={}", table_of(*side), processors)));
  }
  return lines;
}

int most_ranks_of(const std::filesystem::path& case_file, const std::vector<std::string>& sets) {
  const CaseFile file = CaseFile::load(case_file, sets);
  double most = 1;
  const auto look = [&](const CaseFile& in, const std::string& key) {
    for (const double ranks : in.numbers_at(key)) most = std::max(most, ranks);
  };
  look(file, "fluid.ranks");
  if (file.bodies().empty()) look(file, "structure.ranks");
  for (const std::string& body : file.bodies()) look(file.of_body(body), "structure.ranks");
  return static_cast<int>(std::min(most, 4096.0));
}

}  // namespace strake
