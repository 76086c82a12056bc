#pragma once

#include "coupler/study/plan.hpp"
#include "coupler/study/runner.hpp"
#include "proto/files/json_file.hpp"

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
  std::string unit = {};     // of value and reference; of the deviation where the reference is 0
};
/// From an entry of study.json. What is missing there is empty.
CheckResult check_of(const Json&);
/// From an entry of "compare" in summary.json: the verdict of a run on its own case.
CheckResult verdict_of(const Json&);
/// The study's checks, its references, then those that each case brings along (summary.json, "compare").
std::vector<CheckResult> judge_checks(const Results&);

/// How a result behaves as the spacing or the step shrinks.
struct GridConvergence {
  std::string title, axis, probe, metric;
  std::vector<std::string> runs;  // names, coarse to fine
  std::vector<double> along;      // [m] or [s], coarse to fine
  std::vector<double> value;
  std::optional<double> order;         // observed on the three finest
  std::optional<double> extrapolated;  // to zero spacing
  std::optional<double> gci;           // relative, of the finest: 1.25 |e| / (r^p − 1)
  std::string remark;                  // "converges", "oscillates", "does not converge", "two values only"
};

/// Observed order p, extrapolated value and grid convergence index of the three finest of `value`, whose
/// spacings `along` descend in any ratios r21 = h2/h1, r32 = h3/h2 (1 the finest). With φ = φ0 + C h^p,
///   ε32/ε21 = r21^p (r32^p − 1)/(r21^p − 1),  ε32 = φ3 − φ2, ε21 = φ2 − φ1
///   φ0 = φ1 − ε21/(r21^p − 1),  GCI = 1.25 |ε21/φ1| / (r21^p − 1)
/// (Roache 1994, J. Fluids Eng. 116:405; the procedure of Celik et al. 2008, J. Fluids Eng. 130:078001).
/// Differences that alternate in sign have no such order; those that do not fall mean that the result does
/// not converge.
GridConvergence grid_convergence(std::vector<double> along, std::vector<double> value);

/// Every convergence that the plan requests, for each choice on the other axes.
std::vector<GridConvergence> judge_convergence(const Results&);

/// A published sentence beside what was measured.
struct ClaimResult {
  std::string claim, source;
  std::string measured;  // the numbers that decide, in words
  std::string verdict;   // "holds" | "does not hold" | "cannot be judged"
  std::string why;
};

/// Each claim of the plan by its rule. A claim whose runs are missing cannot be judged, and says which are.
std::vector<ClaimResult> judge_claims(const Results&);

}  // namespace strake::study
