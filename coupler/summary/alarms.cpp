#include "coupler/summary/alarms.hpp"

#include "proto/lookup.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace strake {
namespace {

/// What an alarm says. The lengths of the step in use and of the flow's own step are known for each.
struct AlarmWords {
  const char* kind;
  const char* unit;
  std::string (*what)(double value, double bound);
  const char* cause;  // where the step is not the suspect
  const char* remedy;
};

std::string pressure_text(double pascal) {
  const double size = std::abs(pascal);
  if (size >= 1e6) return fmt::format("{:.3g} MPa", 1e-6 * pascal);
  if (size >= 1e3) return fmt::format("{:.3g} kPa", 1e-3 * pascal);
  return fmt::format("{:.3g} Pa", pascal);
}

const std::array<AlarmWords, 6> all_words = {
    AlarmWords{"speed", "m/s",
               [](double value, double bound) {
                 return fmt::format("water at {:.3g} m/s, where this flow gives at most {:.3g}", value,
                                    bound);
               },
               "particles are too coarse for the jet or the contact", "half of fluid.spacing"},
    AlarmWords{"pressure", "Pa",
               [](double value, double bound) {
                 return fmt::format("{} on the body, where this impact gives at most {}",
                                    pressure_text(value), pressure_text(bound));
               },
               "particles are too coarse for the contact", "half of fluid.spacing"},
    AlarmWords{
        "dry", "1",
        [](double value, double) {
          return fmt::format("faces under water have lost it, they carry {:.0f} % of its load", 100 * value);
        },
        "the water did not touch the body at the start, or does not follow it",
        "a body whose faces lie on multiples of fluid.spacing, another fluid.spacing, or shorter windows"},
    AlarmWords{"momentum", "1",
               [](double value, double bound) {
                 return fmt::format("{:.3g} % of the momentum has no source, more than {:.3g} %", 100 * value,
                                    100 * bound);
               },
               "pressure on faces and in the water differ", "half of fluid.spacing"},
    AlarmWords{"volume", "1",
               [](double value, double bound) {
                 return fmt::format("the water's volume has changed by {:+.3g} %, more than {:.3g} %",
                                    100 * value, 100 * bound);
               },
               "particles have spread or piled up", "half of fluid.spacing"},
    AlarmWords{"hollow", "1",
               [](double value, double bound) {
                 return fmt::format(
                     "the water has come apart inside, at {:.3g} % of its particles, more than {:.3g} %",
                     100 * value, 100 * bound);
               },
               "tension has opened holes", "half of fluid.spacing"}};

constexpr double short_step = 0.2;  // of the flow's own, below which the step is the suspect

/// air: air under the body is computed, and has been compressed.
std::string advice_of(const AlarmWords& words, double step, double flow_step, bool air) {
  if (air && std::string_view(words.kind) == "pressure")
    return "probably a thin pocket of air that water closes, which the particles do not show well; do not "
           "use what "
           "follows, or try half of fluid.spacing";
  if (step > 0 && step < short_step * flow_step)
    return fmt::format(
        "probably single particles between jet and wall, in steps of {:.1g} s that are short for this flow; "
        "try "
        "fluid.scheme.time_step = {:.1g} with a window as long, or half of fluid.spacing",
        step, flow_step);
  return fmt::format("probably {}; try {}", words.cause, words.remedy);
}

}  // namespace

std::vector<RaisedAlarm> alarms_of(const std::map<std::string, double>& monitor) {
  std::vector<RaisedAlarm> alarms;
  for (const AlarmWords& words : all_words) {
    const auto part = [&](const char* name) {
      return at_or(monitor, fmt::format("alarm.{}.{}", words.kind, name), std::nan(""));
    };
    RaisedAlarm alarm{.kind = words.kind, .time = part("time"), .line = {}};
    if (!std::isfinite(alarm.time)) continue;
    alarm.value = part("value");
    alarm.bound = part("bound");
    alarm.x = part("x");
    alarm.y = part("y");
    alarm.z = part("z");
    alarm.placed = std::isfinite(alarm.x) && std::isfinite(alarm.y) && std::isfinite(alarm.z);
    alarm.line = fmt::format("t = {:.6g} s", alarm.time);
    if (alarm.placed) alarm.line += fmt::format(" at ({:.4g}, {:.4g}, {:.4g}) m", alarm.x, alarm.y, alarm.z);
    alarm.line += fmt::format(": {}; {}", words.what(alarm.value, alarm.bound),
                              advice_of(words, part("step"), at_or(monitor, "alarm.flow_step", std::nan("")),
                                        monitor.contains("air.mass")));
    alarms.push_back(std::move(alarm));
  }
  std::stable_sort(alarms.begin(), alarms.end(),
                   [](const RaisedAlarm& a, const RaisedAlarm& b) { return a.time < b.time; });
  return alarms;
}

std::vector<std::string> AlarmNotes::look(const std::map<std::string, double>& monitor) {
  std::vector<std::string> lines;
  for (const RaisedAlarm& alarm : alarms_of(monitor))
    if (!std::exchange(told_[alarm.kind], true) && alarm.time > since_) lines.push_back(alarm.line);
  return lines;
}

Json json_of(const RaisedAlarm& alarm) {
  return {{"kind", alarm.kind},
          {"time", finite(alarm.time)},
          {"at", alarm.placed ? Json{alarm.x, alarm.y, alarm.z} : Json(nullptr)},
          {"value", finite(alarm.value)},
          {"bound", finite(alarm.bound)},
          {"text", alarm.line}};
}

}  // namespace strake
