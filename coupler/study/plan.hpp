#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake::study {

/// One choice on an axis: what it sets in the case.
struct AxisValue {
  std::string label;              // part of the run's name
  std::vector<std::string> sets;  // KEY=VALUE
  std::optional<double> at;       // its number, for convergence: a spacing in m, a step in s
  std::string replay;             // label on the same axis: the loads that run recorded drive this one
};
struct Axis {
  std::string name;
  std::vector<AxisValue> values;
};

/// One run: a choice on every axis.
struct PlannedRun {
  std::string name;                          // the labels in the axes' order, "6.26-fem"
  std::map<std::string, std::string> label;  // axis → label
  std::vector<std::string> sets;             // of the study, then of each axis
  std::string source;  // name of the run whose loads it replays; empty: it runs its case
};

/// A number of a run. It is the metric of a probe ("mid.y", "first_peak"), or of the run itself (no probe):
/// "momentum_gap" and the other checks, "wall", "iterations".
struct Quantity {
  std::string probe, metric;
  std::string name() const { return probe.empty() ? metric : probe + ":" + metric; }
};

/// Runs that have these labels; an axis that is not named is free.
using Filter = std::map<std::string, std::string>;

/// Two choices on one axis that are compared, for every choice on the others.
struct Check {
  std::string title, axis, of, against;
  Quantity quantity;  // its metric may be l2 or dtw, of the whole record
  double tolerance = 0;
  Filter where;
};

/// Published or derived numbers along an axis, and who gives them. Those that the study's settings were
/// fitted to are shown beside the measured ones and not judged.
struct Reference {
  std::string title, axis, kind,
      source;  // kind as in a compare block: experiment | theory | code | calibration
  Quantity quantity;
  std::map<std::string, double> value;  // label on the axis → number, SI
  std::vector<std::string> fitted;      // labels whose number chose the settings
  std::optional<double> tolerance;      // relative; none: stated only
  Filter where;
};

/// Order and uncertainty along an axis of numbers, for every choice on the others.
struct Convergence {
  std::string title, axis;
  Quantity quantity;
  Filter where;
};

/// A sentence of the paper, and the rule that judges it from what was measured.
struct Claim {
  enum class Rule { increases, decreases, same, agree, differ, same_time, decays, at_most, none };
  std::string claim, source, why;
  Rule rule = Rule::none;
  std::string axis, of, against;  // agree, differ: `of` against `against`; the others go along the axis
  Quantity quantity;
  std::string other_probe;  // same_time: its peak of the same metric
  double tolerance = 0;
  Filter where;
};

/// A study file, read and checked.
struct Plan {
  std::filesystem::path file, case_file;
  std::string title;
  int jobs = 0;  // 0: one for each core
  std::vector<Axis> axes;
  std::vector<PlannedRun> runs;  // a run stands behind the one it replays
  std::vector<Quantity> columns;
  std::vector<Check> checks;
  std::vector<Reference> references;
  std::vector<Convergence> convergences;
  std::vector<Claim> claims;

  const Axis& axis(const std::string& name) const;
};

/// Reads a plan. Throws Error(case_file) with file, line and fix for unknown keys, labels or axes, names that
/// cannot be folders, and two runs of one name.
Plan read_plan(const std::filesystem::path&);

}  // namespace strake::study
