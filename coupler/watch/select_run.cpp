#include "coupler/watch/select_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace strake::watch {
namespace {

constexpr std::array<std::string_view, 7> accounts = {"window",   "time", "iterations",         "residual",
                                                      "work_gap", "cfl",  "pressure_iterations"};

bool of_a_probe(const WatchedRun& run, const std::string& column) {
  return std::any_of(run.probes().begin(), run.probes().end(), [&](const std::string& probe) {
    return column == probe || column.starts_with(probe + ".");
  });
}

}  // namespace

std::vector<std::size_t> chosen_columns(const WatchedRun& run, std::size_t most) {
  const auto& columns = run.history().columns();
  std::vector<std::size_t> chosen;
  const auto add = [&](std::size_t column) {
    if (chosen.size() < most && std::find(chosen.begin(), chosen.end(), column) == chosen.end())
      chosen.push_back(column);
  };
  for (const std::string& probe : run.probes()) {
    for (const std::string& name : {probe, probe + ".y"})
      if (const auto column = run.history().find(name)) {
        add(*column);
        break;
      }
  }
  if (const auto force = run.history().find("force.y")) add(*force);
  if (const auto residual = run.history().find("residual")) add(*residual);
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (std::find(accounts.begin(), accounts.end(), columns[c].name) == accounts.end() &&
        !of_a_probe(run, columns[c].name) && !columns[c].name.starts_with("force."))
      add(c);
  for (const std::string_view name : {"cfl", "pressure_iterations"})
    if (const auto column = run.history().find(name)) add(*column);
  return chosen;
}

bool is_logarithmic(const std::string& column) {
  return column == "residual" || column.starts_with("residual.");
}

std::vector<Stage> stages(const WatchedRun& run) {
  const TableTail& timing = run.timing();
  std::vector<Stage> found;
  double total = 0, told = 0;
  for (std::size_t c = 0; c < timing.columns().size(); ++c) {
    const std::string& name = timing.columns()[c].name;
    if (name == "window" || name == "time") continue;
    if (name == "wall") {  // of each window; the stages are sums so far
      for (const double s : timing.value()[c]) total += std::isfinite(s) ? s : 0;
      continue;
    }
    const double seconds = timing.last(name).value_or(0);
    told += seconds;
    found.push_back({name, seconds});
  }
  if (total > told && told > 0) found.push_back({"exchange and the rest", total - told});
  std::sort(found.begin(), found.end(), [](const Stage& a, const Stage& b) { return a.seconds > b.seconds; });
  return found;
}

Extremes extremes(const TableTail& table, std::size_t column) {
  Extremes found;
  const auto clock = table.find("time");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double value = table.value()[column][row], time = clock ? table.value()[*clock][row] : 0;
    if (!std::isfinite(value)) continue;
    if (!found.any || value < found.lo) {
      found.lo = value;
      found.time_lo = time;
    }
    if (!found.any || value > found.hi) {
      found.hi = value;
      found.time_hi = time;
    }
    found.any = true;
  }
  return found;
}

}  // namespace strake::watch
