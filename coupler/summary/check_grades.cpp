#include "coupler/summary/check_grades.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace strake {
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
