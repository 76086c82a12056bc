#include <fmt/format.h>

#include <cstdio>

#include "coupler/case_view.hpp"
#include "coupler/commands.hpp"
#include "coupler/console.hpp"
#include "coupler/run_folder.hpp"
#include "coupler/session.hpp"
#include "coupler/stop_request.hpp"

namespace strake {

/// Everything that `run` would refuse, the set-up of both solvers included; no window is advanced, nothing
/// stays.
ExitCode check(const CheckOptions& options, const StopRequest& stop) {
  const CaseView view = read_case(options.case_file, options.sets, &stop);
  const TemporaryFolder folder;
  const Session session(view, {.run_folder = {},
                               .log_folder = folder.path(),
                               .patient = options.patient,
                               .say = [](const std::string& line) { fmt::print(stderr, "{}\n", line); },
                               .stop = &stop});
  fmt::print("{}\n", view.common.title.empty() ? options.case_file.string() : view.common.title);
  for (const auto& [name, lines] : session.understood()) fmt::print("{}", block_text(name, lines));
  fmt::print("{}", block_text("mapping", session.mapping_lines()));
  for (const std::string& warning : session.warnings()) fmt::print("  warning    {}\n", warning);

  fmt::print("\nevery value and where it came from\n{}", view.resolved);
  fmt::print("\n{}: nothing to refuse\n  next    strake run {}\n", options.case_file.string(),
             options.case_file.string());
  return ExitCode::done;
}

}  // namespace strake
