#pragma once

#include "coupler/compare/compare_block.hpp"
#include "coupler/compare/curve.hpp"
#include "coupler/study/results.hpp"
#include "proto/files/history.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake::report {

/// A key of the resolved case as case.toml writes it.
struct Setting {
  std::string key, value, unit, origin;  // origin: default | preset | case | --set
};

/// What a probe found: metric → value in the order of summary.json.
struct ProbeResult {
  std::string probe, unit;
  std::vector<std::pair<std::string, std::optional<double>>> metrics;
  std::optional<double> metric(const std::string& name) const;
};

/// One line of summary.json's "failure": when and where, in the reference configuration.
struct FailureEvent {
  std::string body;  // of several, its name
  std::string name;
  std::optional<double> time, x, y, z;
};

/// Who ran it, and how: of run.json.
struct Origin {
  std::string version, commit, started, error;
  std::string host, compiler;
  std::vector<std::string> command;
  std::optional<double> threads;   // of one process at most
  std::vector<std::string> ranks;  // of a side that has several: "fluid: 2 ranks × 1"
};

/// How a check turned out: "good" up to the first bound, "poor" up to the second, else "bad".
struct CheckGrade {
  std::string grade;
  std::optional<double> good, poor;
};

/// A curve with which a column of the run is compared.
struct ReferenceCurve {
  std::string probe, name;  // name: of its file, and its kind
  Curve curve;
};

/// A run folder as it lies on disk, whole or not: what cannot be read is said in `problems`, and the rest
/// still shows.
struct Recorded {
  std::filesystem::path folder;
  std::string name;   // of the folder; a study gives its own
  std::string title;  // of the case
  std::vector<std::string> problems;
  std::vector<std::pair<std::string, std::string>> notes;  // "physics" → text, from the case's first lines
  std::vector<Setting> settings;

  Origin origin;
  std::map<std::string, std::string> solver;  // side → "fem"
  std::optional<int> exit_code;
  std::optional<double> end_time, wall_seconds, windows, mean_iterations;
  std::map<std::string, double> contact;  // probe → [s]
  std::vector<ProbeResult> probes;
  std::vector<std::pair<std::string, std::optional<double>>> checks;
  std::map<std::string, CheckGrade> grades;  // check → how it turned out
  std::vector<std::string> alarms, resolution;
  std::vector<study::CheckResult> compare;
  std::vector<ReferenceCurve> reference_curves;
  std::vector<CompareBlock> blocks;  // that apply, of its case
  std::vector<FailureEvent> failure;
  std::map<std::string, double> failure_energy;  // [J] of each body that may fail; "": of the only one
  Table history;

  const ProbeResult* probe(const std::string& name) const;
  /// The block of the case that gave a verdict; null where the case is not whole.
  const CompareBlock* block_of(const study::CheckResult&) const;
  std::string setting(const std::string& key) const;  // empty: none
  std::string state() const;                          // "finished", "stopped by the user" …
  bool finished() const { return exit_code == 0 || exit_code == 1; }
};

/// The head of a table with a column for each run, behind those of `first`.
std::vector<std::string> head_of(const std::vector<Recorded>&, std::vector<std::string> first);

/// The name of a run folder: "plate_entry" of "runs/plate_entry/".
std::string name_of_run(const std::filesystem::path& folder);

/// Never throws for a damaged run; throws Error(case_file) where the folder is no run at all.
Recorded read_run(const std::filesystem::path& folder);

}  // namespace strake::report
