#include "coupler/summary/notes.hpp"

#include "coupler/case/side_programs.hpp"
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

namespace {

using Words = std::pair<const char*, const char*>;
constexpr std::array<Words, 3> events = {Words{"start", "failure begins: the strength is reached"},
                                         Words{"crack", "the first crack opens"},
                                         Words{"parted", "a crack has parted the body"}};
constexpr std::array<const char*, 4> parts = {"time", "x", "y", "z"};

/// What stands before a body's columns.
std::string before(const std::string& body) {
  return body.empty() ? "" : body + ".";
}

Json json_of(const std::map<std::string, double>& monitor, const std::string& body) {
  const auto energy = monitor.find(before(body) + "failure.energy");
  if (energy == monitor.end()) return nullptr;
  Json json;
  for (const auto& [event, words] : events) {
    const std::string name = fmt::format("{}failure.{}.", before(body), event);
    json[event] = nullptr;
    if (!monitor.contains(name + "time")) continue;
    Json place;
    for (const char* part : parts) place[part] = monitor.at(name + part);
    json[event] = place;
  }
  json["energy"] = energy->second;
  return json;
}

}  // namespace

std::vector<std::string> FailureNotes::look(const std::map<std::string, double>& monitor) {
  std::vector<std::string> lines;
  if (bodies_.empty()) look_at("", monitor, lines);
  for (const std::string& body : bodies_) look_at(body, monitor, lines);
  return lines;
}

void FailureNotes::look_at(const std::string& body, const std::map<std::string, double>& monitor,
                           std::vector<std::string>& lines) {
  for (const auto& [event, words] : events) {
    const std::string name = fmt::format("{}failure.{}.", before(body), event);
    const auto time = monitor.find(name + "time");
    if (time == monitor.end() || std::exchange(told_[name], true) || time->second <= since_) continue;
    lines.push_back((body.empty() ? "" : body + ": ") +
                    fmt::format("{}, t = {:.6g} s at ({:.4g}, {:.4g}, {:.4g}) m of the body as it was", words,
                                time->second, monitor.at(name + "x"), monitor.at(name + "y"),
                                monitor.at(name + "z")));
    if (std::string(event) == "parted" && dry_faces_)
      lines.push_back(
          "the faces of the crack stay dry: the wet surface is that of the whole body; "
          "coupling.interface = \"volume\" wets them (structure.solver = \"particle\")");
  }
}

std::vector<std::string> PreciceNotes::look(const std::string& side,
                                            const std::map<std::string, double>& monitor) {
  std::vector<std::string> lines;
  if (const std::string line = other_window_line(side, at_or(monitor, "precice.window", 0.0), window_);
      !line.empty() && !std::exchange(told_[side + " window"], true))
    lines.push_back(line);
  if (const auto read = monitor.find("precice.start_read");
      read != monitor.end() && !std::exchange(told_[side + " start_read"], true))
    lines.push_back(fmt::format(
        "{}: in the window from t = {:.6g} s it read the partner's data at relative time 0 alone, the "
        "window's start: what it got is one window old. For the end read at getMaxTimeStepSize()",
        side, read->second));
  return lines;
}

std::vector<std::string> EmptyCellNotes::look(const std::string& side, double time, bool one_of_several,
                                              const std::map<std::string, double>& monitor) {
  std::vector<std::string> lines;
  for (const auto& [name, value] : monitor) {
    if (!std::isnan(value) || (one_of_several && !name.starts_with(side + "."))) continue;
    const std::string there = one_of_several ? name : side + "." + name;  // where two columns share a name
    for (const std::string& column : {name, there})
      if (std::find(columns_.begin(), columns_.end(), column) != columns_.end() &&
          !std::exchange(told_[column], true))
        lines.push_back(
            fmt::format("{}: {} is no number (nan) at t = {:.6g} s; such cells of history.csv stay empty",
                        side, column, time));
  }
  return lines;
}

Json failure_json(const std::map<std::string, double>& monitor, const std::vector<std::string>& bodies) {
  if (bodies.empty()) return json_of(monitor, "");
  Json json;
  for (const std::string& body : bodies) json[body] = json_of(monitor, body);
  return json;
}

namespace {

/// The bounds. The guard of the fluid raises its alarms at the second ones (fluid/diagnostics/guard.cpp).
///
/// - work_gap: the loads go back through the transposed matrix, so that only round-off is left
/// (coupler/THEORY.md,
///   section 9). Other mappings keep the work to some per cent.
/// - momentum_gap: the default scheme keeps it to 1 % on wedges and to 6 % on plates (cases/VALIDATION.md,
///   "Momentum gap"). A load cannot be known better than the momentum it comes from.
/// - structure_energy_drift: finite elements keep it to round-off, elastic particles to 1 %.
/// - speed, pressure: shares of the guard's bound, which is 1.3 times what theory gives.
/// - volume_drift: the measure itself is exact to some 0.5 % for scattered particles
/// (fluid/diagnostics/volume.hpp).
/// - air_mass: finite volumes; only round-off is left.
/// - openings, penetrations, lost: particles that are not where water is, as shares of the water.
constexpr std::array<CheckBounds, 10> check_bounds = {{
    {"largest_speed", "water's speed", 1 / 1.3, 1, false},
    {"largest_pressure", "pressure on faces", 1 / 1.3, 1, false},
    {"work_gap", "work gap", 1e-6, 0.05, false},
    {"momentum_gap", "momentum gap", 0.02, 0.1, false},
    {"structure_energy_drift", "energy drift", 0.01, 0.05, false},
    {"volume_drift", "volume", 0.01, 0.05, false},
    {"air_mass", "air mass", 1e-12, 1e-6, false},
    {"openings", "openings", 1e-3, 0.02, true},
    {"penetrations", "penetrations", 1e-3, 0.01, true},
    {"lost", "lost", 1e-3, 0.05, true},
}};

Grade grade_of(double value, double good, double poor) {
  const double size = std::abs(value);
  return size <= good ? Grade::good : size <= poor ? Grade::poor : Grade::bad;
}

/// "momentum gap 5.4e-02 (good to 0.02, bad from 0.1)": the value, and the bounds that it keeps or breaks.
std::string graded_text(const CheckBounds& check, double value, const Json& entry) {
  const std::string key = check.key, grade = entry["grade"].get<std::string>();
  const bool of_bound = key.starts_with("largest_"), change = key == "volume_drift";
  const auto bound = [&](const char* which) {
    const double x = entry[which].get<double>();
    if (check.per_particle) return fmt::format("{:.0f}", std::floor(x));
    return of_bound || change ? fmt::format("{:.0f} %", 100 * x) : fmt::format("{:g}", x);
  };
  std::string text = check.per_particle ? fmt::format("{:.0f}", value)
                     : of_bound         ? fmt::format("{:.0f} % of its bound", 100 * value)
                     : change           ? fmt::format("{:+.2f} %", 100 * value)
                                        : fmt::format("{:.1e}", value);
  if (grade == "good")
    text += " (to " + bound("good") + ")";
  else if (grade == "poor")
    text += " (good to " + bound("good") + ", bad from " + bound("poor") + ")";
  else
    text += " (at most " + bound("poor") + ")";
  return fmt::format("{} {}", check.words, text);
}

}  // namespace

std::string name_of(Grade grade) {
  return grade == Grade::good ? "good" : grade == Grade::poor ? "poor" : "bad";
}

Json grades_of(const Json& checks, double particles) {
  Json grades = Json::object();
  for (const CheckBounds& check : check_bounds) {
    const auto value = checks.find(check.key);
    if (value == checks.end() || !value->is_number()) continue;
    const double unit = check.per_particle ? particles : 1;
    const double good = check.good * unit, poor = check.poor * unit;
    grades[check.key] = {
        {"grade", name_of(grade_of(value->get<double>(), good, poor))}, {"good", good}, {"poor", poor}};
  }
  return grades;
}

std::vector<std::string> grade_lines(const Json& checks) {
  std::vector<std::string> lines;
  const auto grades = checks.find("grades");
  if (grades == checks.end()) return lines;
  for (const char* wanted : {"bad", "poor", "good"}) {
    std::string line;
    for (const CheckBounds& check : check_bounds)
      if (const auto entry = grades->find(check.key); entry != grades->end() && (*entry)["grade"] == wanted)
        line += (line.empty() ? "" : "   ") + graded_text(check, checks[check.key].get<double>(), *entry);
    if (!line.empty()) lines.push_back(fmt::format("{:<6}{}", wanted, line));
  }
  return lines;
}

}  // namespace strake
