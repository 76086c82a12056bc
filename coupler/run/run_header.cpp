#include "coupler/run/run_header.hpp"

#include <fmt/format.h>

namespace strake {

RunHeader header_of(const CaseView& view, const Session& session, const RunPlan& plan,
                    const std::filesystem::path& folder, const std::vector<Column>& history, bool resumed) {
  RunHeader header{.title = view.common.title,
                   .folder = folder,
                   .blocks = session.understood(),
                   .warnings = session.warnings(),
                   .coupled = view.coupled(),
                   .dimension = session.dimension(),
                   .columns = session.columns(),
                   .probes = view.common.probes,
                   .history = history,
                   .end_time = plan.end,
                   .windows = plan.n_windows(),
                   .from = plan.start};
  if (std::vector<std::string> lines = session.resolution(); !lines.empty())
    header.blocks.emplace_back("resolution", std::move(lines));
  if (resumed)
    header.blocks.push_back(
        {"resumed", {fmt::format("after window {} (t = {:.6g} s)", plan.start.windows, plan.start.time)}});
  return header;
}

}  // namespace strake
