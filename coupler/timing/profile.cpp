#include "coupler/timing/profile.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace strake {

namespace {

double seconds_of(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

/// The largest first.
std::vector<std::pair<std::string, double>> by_size(const std::map<std::string, double>& stages) {
  std::vector<std::pair<std::string, double>> sorted(stages.begin(), stages.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

}  // namespace

double Profile::Seconds::total() const {
  double sum = messages + coupler + files - together;
  for (const auto& [name, seconds] : computing) sum += seconds;
  return sum;
}

void Profile::add(const Exchange& exchange) {
  ClockOffset& clock = clocks_[exchange.participant];
  clock.learn(exchange);
  if (exchange.iteration == 0) return;  // set-up, checkpoints: no part of a window
  const ClockOffset::Span span = clock.computing(exchange);
  seconds_.computing[exchange.participant] += seconds_of(span.end - span.begin);
  computing_.push_back({span.begin, span.end});
  awaiting_.push_back({exchange.sent, exchange.heard});
}

std::pair<std::int64_t, std::int64_t> Profile::covered(std::vector<Span>& spans) {
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) { return a.begin < b.begin; });
  std::int64_t any = 0, twice = 0, reached = 0;  // at most two participants compute at once
  for (const Span& span : spans) {
    const std::int64_t fresh = std::max(span.begin, reached);
    if (span.end > fresh) any += span.end - fresh;
    if (reached > span.begin) twice += std::min(reached, span.end) - span.begin;
    reached = std::max(reached, span.end);
  }
  return {any, twice};
}

void Profile::end_window(const WindowReport& report, std::int64_t begin, std::int64_t end,
                         std::int64_t files_end) {
  const auto [computed, together] = covered(computing_);
  const auto [awaited, unused] = covered(awaiting_);
  computing_.clear();
  awaiting_.clear();
  seconds_.together += seconds_of(together);
  seconds_.messages += seconds_of(awaited - computed);
  seconds_.coupler += seconds_of(end - begin - awaited);
  seconds_.files += seconds_of(files_end - end);
  ++windows_;
  iterations_ += report.iterations;
  const std::string prefix = "seconds.";
  for (const auto& [name, monitor] : {std::pair{"fluid", &report.fluid}, {"structure", &report.structure}}) {
    if (auto shares = rank_shares(*monitor); !shares.empty()) ranks_[name] = std::move(shares);
    for (const auto& [key, value] : *monitor)
      if (key.starts_with(prefix)) stages_[name][key.substr(prefix.size())] = value;
  }
}

std::vector<std::string> Profile::lines() const {
  const double total = seconds_.total();
  const auto line = [&](const std::string& name, double seconds, const std::string& what) {
    return fmt::format("  {:<11}{:>9.3f} s  {:>5.1f} %  {}", name, seconds,
                       total > 0 ? 100 * seconds / total : 0, what);
  };
  std::vector<std::string> lines = {fmt::format(
      "profile  {} windows, {} iterations, {:.3f} s for windows and files", windows_, iterations_, total)};
  for (const auto& [name, computing] : seconds_.computing) {
    lines.push_back(line(name, computing, fmt::format("computing, waiting {:.3f} s", total - computing)));
    const auto stages = stages_.find(name);
    if (stages == stages_.end()) continue;
    for (const auto& [stage, seconds] : by_size(stages->second))
      lines.push_back(fmt::format("    {:<20}{:>9.3f} s", stage, seconds));
    if (const auto ranks = ranks_.find(name); ranks != ranks_.end())
      for (std::string& row : rank_lines(ranks->second)) lines.push_back(std::move(row));
  }
  if (seconds_.together > 0)
    lines.push_back(line("together", seconds_.together, "both computing, counted in each"));
  lines.push_back(line("messages", seconds_.messages, "on their way, and processes waking up"));
  lines.push_back(line("coupler", seconds_.coupler, "mapping, acceleration, accounts"));
  lines.push_back(line("files", seconds_.files, "histories, the recorded interface, checkpoints, console"));
  return lines;
}

Json Profile::json() const {
  Json json = {{"windows", windows_},
               {"iterations", iterations_},
               {"total", seconds_.total()},
               {"computing", seconds_.computing},
               {"together", seconds_.together},
               {"messages", seconds_.messages},
               {"coupler", seconds_.coupler},
               {"files", seconds_.files},
               {"stages", stages_}};
  return json;
}

}  // namespace strake
