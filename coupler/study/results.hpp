#pragma once

#include "coupler/study/plan.hpp"
#include "coupler/study/runner.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake::study {

/// What a run found, from its summary.json: "mid.y:first_peak", "momentum_gap", "wall", "iterations",
/// "failure.crack.x" …
using Values = std::map<std::string, double>;
Values read_values(const std::filesystem::path& run_folder);

/// Everything a study found.
struct Results {
  const Plan* plan = nullptr;
  std::map<std::string, Outcome> outcome;   // by run
  std::map<std::string, Values> values;     // of the runs that are done
  std::map<std::string, std::string> unit;  // of the probes, "mid.y" → "m"
  std::optional<double> value(const PlannedRun&, const Quantity&) const;
  std::string unit_of(const Quantity&) const;  // "1" if no run has one
  /// Planned runs that have these labels, in the plan's order.
  std::vector<const PlannedRun*> runs(const Filter&) const;
};
Results collect(const Plan&, std::map<std::string, Outcome>);
/// Throws Error(case_file) for a probe that the plan asks for and no finished run has.
void refuse_unknown_probes(const Results&);

/// One deviation and its limit.
struct CheckResult {
  std::string title, run, against;  // names of runs; against empty: a reference of the case
  std::string probe, metric;
  std::optional<double> value, reference, deviation;
  std::optional<double> tolerance;
  std::optional<bool> pass;  // none: stated only
  std::string kind, source;  // as in a compare block
};
/// The study's checks, its references, then those that each case brings along (summary.json, "compare").
std::vector<CheckResult> judge_checks(const Results&);

}  // namespace strake::study
