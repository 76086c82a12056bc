#include "coupler/coupling/window_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace strake {

bool IterationReport::settled() const {
  return std::all_of(fields.begin(), fields.end(),
                     [](const FieldResidual& field) { return field.settled(); });
}

double InterfaceWork::gap() const {
  const double larger = std::max(std::abs(fluid), std::abs(structure));
  return larger == 0 ? 0 : std::abs(fluid - structure) / larger;
}

Eigen::Vector3d WindowReport::total_force() const {
  return force.cols() == 0 || log.empty() ? Eigen::Vector3d(0, 0, 0) : log.back().force;
}

std::map<std::string, double> WindowReport::monitor() const {
  std::map<std::string, double> merged;
  for (const auto* side : {&fluid, &structure, &attachments})
    for (const auto& [name, value] : *side) {
      const auto begins = [&name = name](std::string_view prefix) { return name.starts_with(prefix); };
      if (!begins("seconds.") && !begins("count.") && !begins("check.") && !begins("memory.") &&
          !begins("alarm.") && !begins("ranks."))
        merged.emplace(name, value);
    }
  return merged;
}

std::vector<RankShare> rank_shares(const std::map<std::string, double>& monitor, const std::string& body) {
  static const std::map<std::string, double RankShare::*> members = {
      {"busy", &RankShare::busy},           {"halo", &RankShare::halo},     {"waiting", &RankShare::waiting},
      {"particles", &RankShare::particles}, {"ghosts", &RankShare::ghosts}, {"memory", &RankShare::memory},
      {"sent", &RankShare::sent},           {"cpu", &RankShare::cpu}};
  std::vector<RankShare> shares;
  for (std::size_t rank = 0;; ++rank) {
    const std::string prefix = fmt::format("{}{}ranks.{}.", body, body.empty() ? "" : ".", rank);
    if (!monitor.contains(prefix + "busy")) return shares;
    RankShare& share = shares.emplace_back();
    for (const auto& [name, member] : members)
      if (const auto found = monitor.find(prefix + name); found != monitor.end())
        share.*member = found->second;
  }
}

double imbalance(const std::vector<RankShare>& shares) {
  double sum = 0, most = 0;
  for (const RankShare& share : shares) {
    sum += share.busy;
    most = std::max(most, share.busy);
  }
  return sum > 0 ? most * static_cast<double>(shares.size()) / sum : 1;
}

std::vector<std::string> rank_lines(const std::vector<RankShare>& shares) {
  if (shares.empty()) return {};
  constexpr double mebi = 1024.0 * 1024.0;
  std::vector<std::string> lines = {fmt::format(
      "    rank   computing      halo   waiting  particles    ghosts    memory      sent, imbalance {:.2f}",
      imbalance(shares))};
  std::size_t rank = 0;
  for (const RankShare& share : shares)
    lines.push_back(fmt::format(
        "    {:<4} {:>9.3f} s {:>7.3f} s {:>7.3f} s {:>10.0f} {:>8.1f} % {:>5.0f} MiB {:>5.0f} MiB", rank++,
        share.busy, share.halo, share.waiting, share.particles,
        share.particles > 0 ? 100 * share.ghosts / share.particles : 0, share.memory / mebi,
        share.sent / mebi));
  return lines;
}

}  // namespace strake
