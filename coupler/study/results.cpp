#include "coupler/study/results.hpp"

#include "coupler/compare/comparison.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"
#include "proto/lookup.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace strake::study {
namespace {

void take_numbers(const Json& object, const std::string& prefix, Values& values) {
  if (!object.is_object()) return;
  for (const auto& [name, value] : object.items())
    if (value.is_number()) values[prefix + name] = value.get<double>();
}

/// Events of a failure and its energy, "failure.crack.time"; of several bodies "failure.left.crack.time".
void take_failure(const Json& failure, const std::string& prefix, Values& values) {
  take_numbers(failure, prefix, values);
  if (!failure.is_object()) return;
  for (const auto& [name, part] : failure.items()) take_failure(part, prefix + name + ".", values);
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
    result.deviation = deviation(*result.value, *result.reference);
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
  if (result.value) result.deviation = deviation(*result.value, expected);
  const std::string& label = run.label.at(reference.axis);
  if (std::find(reference.fitted.begin(), reference.fitted.end(), label) != reference.fitted.end()) {
    result.tolerance.reset();
    result.source = "fitted to it, not judged: " + result.source;
  }
  if (result.tolerance) result.pass = result.deviation && std::abs(*result.deviation) <= *result.tolerance;
  return result;
}

}  // namespace

CheckResult check_of(const Json& json) {
  return {.title = string_of(json, "title"),
          .run = string_of(json, "run"),
          .against = string_of(json, "against"),
          .probe = string_of(json, "probe"),
          .metric = string_of(json, "metric"),
          .value = number_of(json, "value"),
          .reference = number_of(json, "reference"),
          .deviation = number_of(json, "deviation"),
          .tolerance = number_of(json, "tolerance"),
          .pass = flag_of(json, "pass"),
          .kind = string_of(json, "kind"),
          .source = string_of(json, "source"),
          .unit = string_of(json, "unit")};
}

CheckResult verdict_of(const Json& json) {
  CheckResult result = check_of(json);
  result.title = fmt::format("{} {}", result.probe, result.metric);
  if (result.value && result.reference) result.deviation = deviation(*result.value, *result.reference);
  return result;
}

Values read_values(const std::filesystem::path& folder) {
  const Json summary = read_json(folder / "summary.json");
  const Json& iterations = member(summary, "iterations");
  Values values;
  for (const auto& [probe, entry] : member(summary, "probes").items())
    take_numbers(entry, probe + ":", values);
  take_numbers(member(summary, "checks"), "", values);
  take_numbers(iterations, "iterations.", values);
  if (const auto mean = number_of(iterations, "mean")) values["iterations"] = *mean;
  take_failure(member(summary, "failure"), "failure.", values);
  if (const auto wall = number_of(member(summary, "seconds"), "wall")) values["wall"] = *wall;
  if (const auto windows = number_of(summary, "windows")) values["windows"] = *windows;
  return values;
}

std::optional<double> Results::value(const PlannedRun& run, const Quantity& q) const {
  const auto found = values.find(run.name);
  if (found == values.end() || !found->second.contains(q.name())) return std::nullopt;
  return found->second.at(q.name());
}

std::string Results::unit_of(const Quantity& q) const {
  if (q.probe.empty()) {
    const bool of_failure = q.metric.starts_with("failure.");
    if (q.metric == "wall" || (of_failure && q.metric.ends_with(".time"))) return "s";
    if (of_failure) return q.metric.ends_with(".energy") ? "J" : "m";
    return "1";
  }
  return metric_unit(q.metric, at_or(unit, q.probe, "1"));
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
    const Json summary = read_json(o.folder / "summary.json");
    for (const auto& [probe, entry] : member(summary, "probes").items())
      if (member(entry, "unit").is_string()) results.unit.emplace(probe, string_of(entry, "unit"));
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
    const Json summary = read_json(results.outcome.at(run).folder / "summary.json");
    for (const Json& verdict : member(summary, "compare")) {
      all.push_back(verdict_of(verdict));
      all.back().run = run;
    }
  }
  for (CheckResult& check : all) check.unit = results.unit_of({check.probe, check.metric});
  return all;
}

}  // namespace strake::study
