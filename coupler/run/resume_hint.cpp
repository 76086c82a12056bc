#include "coupler/run/resume_hint.hpp"

#include <fmt/format.h>

namespace strake {

Error with_resume_hint(const Error& error, const std::filesystem::path& checkpoint, const LoopState& saved,
                       const Summary& summary) {
  const long lost = summary.windows() - saved.windows;
  const std::string windows = fmt::format("{} finished window{}, {:.6g} s of simulated time", lost,
                                          lost == 1 ? "" : "s", summary.end_time() - saved.time);
  const std::string resume_hint =
      checkpoint.empty()
          ? fmt::format(
                "nothing to go on from: the first checkpoint was still to come (run.checkpoint)\n"
                "lost: {}",
                windows)
          : fmt::format("--resume goes on with window {} (t = {:.6g} s), from {}\ncomputed again: {}",
                        saved.windows + 1, saved.time, checkpoint.string(), windows);
  return Error(error.code(), error.where(), error.problem(),
               error.fix().empty() ? resume_hint : error.fix() + "\n" + resume_hint);
}

}  // namespace strake
