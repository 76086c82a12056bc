#include "coupler/coupling/window_report.hpp"

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

}  // namespace strake
