#include "coupler/study/results.hpp"

#include "coupler/compare/comparison.hpp"
#include "coupler/console/join.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace strake::study {
namespace {

nlohmann::json summary_of(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  return summary.is_object() ? summary : nlohmann::json::object();
}

void take_numbers(const nlohmann::json& object, const std::string& prefix, Values& values) {
  if (!object.is_object()) return;
  for (const auto& [name, value] : object.items())
    if (value.is_number()) values[prefix + name] = value.get<double>();
}

std::map<std::string, std::string> units_of(const nlohmann::json& summary) {
  std::map<std::string, std::string> units;
  if (summary.contains("probes") && summary["probes"].is_object())
    for (const auto& [probe, entry] : summary["probes"].items())
      if (entry.is_object() && entry.contains("unit") && entry["unit"].is_string())
        units[probe] = entry["unit"].get<std::string>();
  return units;
}

/// l2 or dtw of two whole records.
std::optional<double> difference(const Results& results, const PlannedRun& run, const PlannedRun& other,
                                 const Quantity& q) {
  const RecordSource one(results.outcome.at(other.name).folder.string());
  const RecordSource two(results.outcome.at(run.name).folder.string());
  const Comparison c = compare_records({one.record(q.probe), two.record(q.probe)}, q.probe, {});
  for (const MetricRow& row : c.rows)
    if (row.name == q.metric) return row.value[1];
  return std::nullopt;
}

CheckResult judge(const Results& results, const Check& check, const PlannedRun& run,
                  const PlannedRun& other) {
  CheckResult result = {.title = check.title,
                        .run = run.name,
                        .against = other.name,
                        .probe = check.quantity.probe,
                        .metric = check.quantity.metric,
                        .value = results.value(run, check.quantity),
                        .reference = results.value(other, check.quantity),
                        .deviation = {},
                        .tolerance = check.tolerance,
                        .pass = {},
                        .kind = "code",
                        .source = "another solver of the same case"};
  const bool whole = check.quantity.metric == "l2" || check.quantity.metric == "dtw";
  const bool both = results.values.contains(run.name) && results.values.contains(other.name);
  if (whole && both)
    result.value = result.deviation = difference(results, run, other, check.quantity);
  else if (result.value && result.reference && *result.reference != 0)
    result.deviation = (*result.value - *result.reference) / std::abs(*result.reference);
  result.pass = result.deviation && std::abs(*result.deviation) <= check.tolerance;
  return result;
}

CheckResult judge(const Results& results, const Reference& reference, const PlannedRun& run,
                  double expected) {
  CheckResult result = {.title = reference.title,
                        .run = run.name,
                        .against = {},
                        .probe = reference.quantity.probe,
                        .metric = reference.quantity.metric,
                        .value = results.value(run, reference.quantity),
                        .reference = expected,
                        .deviation = {},
                        .tolerance = reference.tolerance,
                        .pass = {},
                        .kind = reference.kind,
                        .source = reference.source};
  if (result.value)
    result.deviation = expected == 0 ? *result.value : (*result.value - expected) / std::abs(expected);
  const std::string& label = run.label.at(reference.axis);
  if (std::find(reference.fitted.begin(), reference.fitted.end(), label) != reference.fitted.end()) {
    result.tolerance.reset();
    result.source = "fitted to it, not judged: " + result.source;
  }
  if (result.tolerance) result.pass = result.deviation && std::abs(*result.deviation) <= *result.tolerance;
  return result;
}

std::optional<double> number_in(const nlohmann::json& object, const char* name) {
  return object.contains(name) && object[name].is_number() ? std::optional(object[name].get<double>())
                                                           : std::nullopt;
}

/// A verdict of the run on its own case.
CheckResult from_case(const std::string& run, const nlohmann::json& verdict) {
  CheckResult result = {.title = {},
                        .run = run,
                        .against = {},
                        .probe = verdict.value("probe", ""),
                        .metric = verdict.value("metric", ""),
                        .value = number_in(verdict, "value"),
                        .reference = number_in(verdict, "reference"),
                        .deviation = {},
                        .tolerance = number_in(verdict, "tolerance"),
                        .pass = {},
                        .kind = verdict.value("kind", ""),
                        .source = verdict.value("source", "")};
  result.title = fmt::format("{} {}", result.probe, result.metric);
  if (verdict.contains("pass") && verdict["pass"].is_boolean()) result.pass = verdict["pass"].get<bool>();
  if (result.value && result.reference)
    result.deviation = *result.reference == 0
                           ? *result.value
                           : (*result.value - *result.reference) / std::abs(*result.reference);
  return result;
}

}  // namespace

Values read_values(const std::filesystem::path& folder) {
  const nlohmann::json summary = summary_of(folder);
  Values values;
  if (summary.contains("probes") && summary["probes"].is_object())
    for (const auto& [probe, entry] : summary["probes"].items()) take_numbers(entry, probe + ":", values);
  if (summary.contains("checks")) take_numbers(summary["checks"], "", values);
  if (summary.contains("iterations") && summary["iterations"].is_object()) {
    take_numbers(summary["iterations"], "iterations.", values);
    if (const auto mean = number_in(summary["iterations"], "mean")) values["iterations"] = *mean;
  }
  if (summary.contains("failure") && summary["failure"].is_object()) {
    take_numbers(summary["failure"], "failure.", values);
    for (const auto& [event, place] : summary["failure"].items())
      take_numbers(place, "failure." + event + ".", values);
  }
  if (summary.contains("seconds"))
    if (const auto wall = number_in(summary["seconds"], "wall")) values["wall"] = *wall;
  if (const auto windows = number_in(summary, "windows")) values["windows"] = *windows;
  return values;
}

std::optional<double> Results::value(const PlannedRun& run, const Quantity& q) const {
  const auto found = values.find(run.name);
  if (found == values.end()) return std::nullopt;
  const auto number = found->second.find(q.name());
  return number == found->second.end() ? std::nullopt : std::optional(number->second);
}

std::string Results::unit_of(const Quantity& q) const {
  if (q.probe.empty()) {
    const bool of_failure = q.metric.starts_with("failure.");
    if (q.metric == "wall" || (of_failure && q.metric.ends_with(".time"))) return "s";
    return of_failure && q.metric != "failure.energy" ? "m" : "1";
  }
  const auto found = unit.find(q.probe);
  return metric_unit(q.metric, found == unit.end() ? "1" : found->second);
}

std::vector<const PlannedRun*> Results::runs(const Filter& filter) const {
  std::vector<const PlannedRun*> chosen;
  for (const PlannedRun& run : plan->runs) {
    bool fits = true;
    for (const auto& [axis, label] : filter) fits = fits && run.label.at(axis) == label;
    if (fits) chosen.push_back(&run);
  }
  return chosen;
}

Results collect(const Plan& plan, std::map<std::string, Outcome> outcome) {
  Results results = {.plan = &plan, .outcome = std::move(outcome), .values = {}, .unit = {}};
  for (const PlannedRun& run : plan.runs) {
    const Outcome& o = results.outcome[run.name];
    if (o.state != Outcome::State::done) continue;
    results.values[run.name] = read_values(o.folder);
    for (const auto& [probe, unit] : units_of(summary_of(o.folder))) results.unit.emplace(probe, unit);
  }
  return results;
}

void refuse_unknown_probes(const Results& results) {
  std::vector<std::string> known;
  for (const auto& [run, values] : results.values)
    for (const auto& [name, value] : values)
      if (const auto colon = name.find(':'); colon != std::string::npos)
        known.push_back(name.substr(0, colon));
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  if (known.empty()) return;
  const auto look = [&](const std::string& table, const std::string& probe) {
    if (probe.empty() || std::find(known.begin(), known.end(), probe) != known.end()) return;
    const std::string near = did_you_mean(probe, known);
    throw Error(ExitCode::case_file,
                fmt::format("{}: [[{}]] probe = \"{}\"", results.plan->file.string(), table, probe),
                "no run has it; they have " + joined(known),
                near.empty() ? "name one of them; a second start runs nothing again"
                             : fmt::format("did you mean \"{}\"? A second start runs nothing again", near));
  };
  const Plan& plan = *results.plan;
  for (const Quantity& q : plan.columns) look("column", q.probe);
  for (const Check& check : plan.checks) look("check", check.quantity.probe);
  for (const Reference& reference : plan.references) look("reference", reference.quantity.probe);
  for (const Convergence& convergence : plan.convergences) look("convergence", convergence.quantity.probe);
}

std::vector<CheckResult> judge_checks(const Results& results) {
  std::vector<CheckResult> all;
  for (const Check& check : results.plan->checks) {
    Filter filter = check.where;
    filter[check.axis] = check.of;
    for (const PlannedRun* run : results.runs(filter)) {
      Filter same(run->label.begin(), run->label.end());
      same[check.axis] = check.against;
      for (const PlannedRun* other : results.runs(same)) all.push_back(judge(results, check, *run, *other));
    }
  }
  for (const Reference& reference : results.plan->references)
    for (const PlannedRun* run : results.runs(reference.where))
      if (const auto found = reference.value.find(run->label.at(reference.axis));
          found != reference.value.end())
        all.push_back(judge(results, reference, *run, found->second));
  for (const auto& [run, values] : results.values) {
    const nlohmann::json summary = summary_of(results.outcome.at(run).folder);
    if (summary.contains("compare") && summary["compare"].is_array())
      for (const auto& verdict : summary["compare"]) all.push_back(from_case(run, verdict));
  }
  return all;
}

}  // namespace strake::study
