#include "coupler/console/console.hpp"
#include "coupler/participant/launch.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/summary/notes.hpp"
#include "coupler/timing/profile.hpp"
#include "proto/files/json_file.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

// The last lines of a run: results, their files, and the next commands.

namespace strake {

namespace {

constexpr std::size_t most_probes = 6;

std::string counted(long number, const std::string& what) {
  return fmt::format("{} {}{}", grouped(number), what, number == 1 ? "" : "s");
}

/// The checks in words, the worst first, then those without a bound.
void add_checks(const Json& checks, std::vector<std::string>& lines) {
  std::vector<std::string> texts = grade_lines(checks);
  std::string others;
  if (const auto inner = number_of(checks, "inner_fraction_min"))
    others = fmt::format("inner particles at least {:.1f} %", 100 * *inner);
  if (const auto voids = number_of(checks, "voids")) others += fmt::format("   voids {:.0f}", *voids);
  if (!others.empty()) texts.push_back("also  " + others);
  for (std::size_t k = 0; k < texts.size(); ++k)
    lines.push_back(fmt::format("  {:<8}{}", k == 0 ? "checks" : "", texts[k]));
}

/// One line that counts the alarms, where there were any.
void add_alarms(const Summary& summary, const Style& style, std::vector<std::string>& lines) {
  const std::vector<RaisedAlarm> alarms = summary.alarms();
  if (alarms.empty()) return;
  std::string kinds;
  for (const RaisedAlarm& alarm : alarms)
    kinds += fmt::format("{}{} from t = {:.4g} s", kinds.empty() ? "" : ", ", alarm.kind, alarm.time);
  lines.push_back("  " + painted(style, "31", counted(static_cast<long>(alarms.size()), "alarm")) + ": " +
                  kinds + "; do not trust the results from there on");
}

std::string value_text(double value, const std::string& unit, const Style& style) {
  Prefix prefix = prefix_for(value, unit);
  if (prefix.text == "µ" && !style.unicode) prefix.text = "u";
  const std::string words = with_prefix(prefix, unit);
  return fmt::format("{:.4g}{}", prefix.factor * value, words.empty() ? "" : " " + words);
}

/// The known results of a probe: "first peak 1.742 mm at 2.35 ms   peak -3.1 mm at 21 ms".
std::string found_text(const Json& probe, const Style& style) {
  const std::string unit = probe["unit"].is_string() ? string_of(probe, "unit") : "1";
  std::string text;
  const auto add = [&](const std::string& words, std::optional<double> value, std::optional<double> time) {
    if (!value) return;
    text += (text.empty() ? "" : "   ") + words + " " + value_text(*value, unit, style);
    if (time) text += " at " + value_text(*time, "s", style);
  };
  const auto first = number_of(probe, "first_peak"), peak = number_of(probe, "peak");
  if (peak == 0.0 && number_of(probe, "final") == 0.0) return {};  // of a body that does not deform
  add("first peak", first, number_of(probe, "time_of_first_peak"));
  if (peak != first) add("peak", peak, number_of(probe, "time_of_peak"));
  add("at the end", number_of(probe, "final"), std::nullopt);
  return text;
}

/// The name of a column without that of its body: "force.y" of "left.force.y".
std::string without_body(const std::string& name) {
  const auto dot = name.find('.');
  const std::string own = dot == std::string::npos ? "" : name.substr(dot + 1);
  return own.starts_with("force.") || own.starts_with("moment.") ? own : name;
}

/// Force and moment on the body, on each of several, and forces of attachments, without components that are
/// round-off beside the largest force.
std::vector<std::string> telling_loads(const Json& probes) {
  constexpr double least_part = 1e-6;  // of the largest force; of a moment a lever arm of a micrometre [m]
  const auto peak_of = [](const Json& entry) { return std::abs(number_of(entry, "peak").value_or(0)); };
  double largest = 0;
  for (const auto& [name, entry] : probes.items())
    if (without_body(name).starts_with("force.")) largest = std::max(largest, peak_of(entry));
  std::vector<std::string> loads;
  for (const auto& [name, entry] : probes.items()) {
    const std::string load = without_body(name);
    if ((load.starts_with("force.") || load.starts_with("moment.")) && largest > 0 &&
        peak_of(entry) > least_part * largest)
      loads.push_back(name);
  }
  return loads;
}

/// The speed and the angle of a rigid body that changed: "body.vy", "left.body.angle". A body that is driven
/// at one speed has nothing to tell.
std::vector<std::string> telling_motions(const Json& probes) {
  constexpr double least = 1e-6;  // of the largest: round-off of a motion that is held
  std::vector<std::string> motions;
  std::map<char, double> largest;  // of speeds, of angles
  const auto kind_of = [](const std::string& name) {
    const auto dot = name.rfind("body.");
    if (dot == std::string::npos || (dot > 0 && name[dot - 1] != '.')) return ' ';
    const std::string what = name.substr(dot + 5);
    return what.starts_with("angle") ? 'a' : what.size() == 2 && what[0] == 'v' ? 'v' : ' ';
  };
  const auto peak_of = [](const Json& entry) { return std::abs(number_of(entry, "peak").value_or(0)); };
  for (const auto& [name, entry] : probes.items())
    largest[kind_of(name)] = std::max(largest[kind_of(name)], peak_of(entry));
  for (const auto& [name, entry] : probes.items()) {
    const char kind = kind_of(name);
    const double change =
        std::abs(number_of(entry, "peak").value_or(0) - number_of(entry, "final").value_or(0));
    const bool changes = kind == 'a' ? peak_of(entry) > 0 : change > least * largest[kind];
    if (kind != ' ' && changes && peak_of(entry) > least * largest[kind]) motions.push_back(name);
  }
  return motions;
}

/// The columns of the table, and beside each the components of its probe that grew larger than it. One that
/// is round-off beside such a component is left out.
std::vector<std::string> telling_probes(const Json& probes, const RunHeader& header) {
  constexpr double least_part = 1e-6;  // of the largest component
  std::vector<std::string> names;
  for (const Column& column : telling_columns(header, most_probes)) names.push_back(column.name);
  const auto peak_of = [&](const std::string& name) {
    return probes.contains(name) ? std::abs(number_of(probes[name], "peak").value_or(0)) : 0.0;
  };
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto dot = names[k].rfind('.');
    if (dot == std::string::npos || dot + 2 != names[k].size()) continue;
    const std::string base = names[k].substr(0, dot + 1);
    double largest = peak_of(names[k]);
    for (const char axis : {'z', 'y', 'x'}) {
      const std::string other = base + axis;
      largest = std::max(largest, peak_of(other));
      if (peak_of(other) > peak_of(names[k]) && std::find(names.begin(), names.end(), other) == names.end())
        names.insert(names.begin() + static_cast<std::ptrdiff_t>(k) + 1, other);
    }
    if (peak_of(names[k]) < least_part * largest)
      names.erase(names.begin() + static_cast<std::ptrdiff_t>(k--));
  }
  return names;
}

void add_found(const Json& probes, const RunHeader& header, const Style& style,
               std::vector<std::string>& lines) {
  std::vector<std::pair<std::string, std::string>> found;
  for (const std::string& name : telling_probes(probes, header))
    if (probes.contains(name))
      if (std::string text = found_text(probes[name], style); !text.empty())
        found.emplace_back(visible(name), visible(text));
  for (const std::string& load : telling_loads(probes))
    found.emplace_back(visible(load), visible(found_text(probes[load], style)));
  for (const std::string& motion : telling_motions(probes)) {
    Json entry = probes[motion];
    entry["first_peak"] = nullptr;
    found.emplace_back(visible(motion), found_text(entry, style));
  }
  std::size_t width = 0;
  for (const auto& [name, text] : found) width = std::max(width, name.size());
  for (std::size_t k = 0; k < found.size(); ++k)
    lines.push_back(
        fmt::format("  {:<8}{:<{}}  {}", k == 0 ? "found" : "", found[k].first, width, found[k].second));
}

}  // namespace

std::vector<std::string> closing_lines(const RunEnd& end, const RunHeader& header, const Style& style) {
  const Summary& summary = *end.summary;
  const Json json = summary.json();
  const std::string folder = visible(end.folder.string());
  std::vector<std::string> lines;
  std::string first = fmt::format("\n{}  {} to t = {:.6g} s", end.stopped.empty() ? "done" : end.stopped,
                                  counted(summary.windows(), "window"), summary.end_time());
  if (summary.coupled()) first += fmt::format(", mean {:.1f} iterations", summary.mean_iterations());
  lines.push_back(first + ", " + duration_text(summary.wall_seconds));
  if (summary.unconverged() > 0)
    lines.push_back("  " +
                    painted(style, "33", counted(summary.unconverged(), "window") + " accepted unconverged"));
  if (summary.taken_back() > 0)
    lines.push_back("  " + painted(style, "33",
                                   counted(summary.taken_back(), "window") + " taken back for shorter ones"));
  for (const Verdict& verdict : summary.verdicts) lines.push_back("  " + verdict_text(verdict, style));
  add_found(json["probes"], header, style, lines);
  for (const std::string& blow : summary.blows())
    lines.push_back("  " + painted(style, "33", "blow") + "    " + visible(blow));
  add_alarms(summary, style, lines);
  add_checks(json["checks"], lines);
  if (end.profile != nullptr)
    for (const std::string& text : end.profile->lines()) lines.push_back("  " + visible(text));

  lines.push_back("  curves  " + folder + "/history.csv");
  lines.push_back("  summary " + folder + "/summary.json");
  if (!end.fields.empty()) {
    std::string fields = folder + "/" + end.fields.front();
    for (std::size_t i = 1; i < end.fields.size(); ++i) fields += "  " + end.fields[i];
    lines.push_back(fmt::format("  fields  {}   (open in ParaView)", fields));
  }
  if (!end.stopped.empty()) lines.push_back("  logs    " + folder + "/*.log");
  std::vector<std::string> next;
  if (end.stopped == "interrupted") next.push_back("the same command with --resume");
  const std::string word = shell_word(folder);
  next.push_back("strake report " + word);
  if (!end.fields.empty()) next.push_back("strake picture " + word);
  if (!summary.verdicts.empty()) next.push_back("strake compare " + word);
  next.push_back("strake watch " + word + " --web");
  for (std::size_t k = 0; k < next.size(); ++k)
    lines.push_back(fmt::format("  {:<8}{}", k == 0 ? "next" : "", next[k]));
  return lines;
}

}  // namespace strake
