#include "coupler/timing/run_clocks.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace strake {

namespace fs = std::filesystem;

RunClocks::RunClocks(fs::path run_folder, const Options& options)
    : folder_(std::move(run_folder)), options_(options) {}

void RunClocks::open() {
  if (!options_.trace) return;
  const fs::path path = folder_ / "trace.json";
  std::error_code none;
  for (int part = 1; options_.resumed && fs::exists(path, none); ++part) {
    const fs::path earlier = folder_ / fmt::format("trace-{}.json", part);
    if (!fs::exists(earlier, none)) fs::rename(path, earlier, none);
    if (none) break;
  }
  trace_.emplace(path);
}

std::function<void(const Exchange&)> RunClocks::observer() {
  if (!trace_ && !options_.profile) return {};
  return [this](const Exchange& exchange) {
    if (trace_) trace_->add(exchange);
    if (options_.profile) profile_.add(exchange);
  };
}

void RunClocks::end_window(const CommittedWindow& window, std::int64_t begin, std::int64_t end) {
  const std::int64_t files_end = Trace::now(), files = files_end - end;
  if (trace_) trace_->add("files", end, files_end);
  if (trace_)
    trace_->end_window(window.number, window.time, window.report.iterations, window.report.converged, begin,
                       end);
  if (options_.profile) profile_.end_window(window.report, begin, end, end + files);
}

}  // namespace strake
