#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/compare/compare.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/summary/notes.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace strake {

/// What a run found, for programs: summary.json. Keys are fixed (proto/RESULTS.md); what is not known is
/// null.
class Summary {
 public:
  Summary(std::string case_name, std::string tag);

  /// Columns of history.csv: where the units of the probes come from.
  void describe(const std::vector<Column>&);
  void add(const CommittedWindow&);
  /// Results of the columns that no participant keeps a record of; taken anew at each call.
  void take_history(const Table& history);

  ExitCode exit_code = ExitCode::done;
  double wall_seconds = 0;
  std::map<std::string, double> coupler_seconds;  // stage → [s]
  double coupler_memory = 0;                      // [bytes] peak
  std::vector<Verdict> verdicts;
  std::vector<std::string> resolution;  // what the spacings resolve, in words
  bool mechanical = true;  // displacement and force cross the interface, so that works can be compared
  std::vector<std::string> bodies;  // names of several; empty: one structure

  double end_time() const { return time_; }
  long windows() const { return windows_; }
  double mean_iterations() const;
  bool coupled() const { return coupled_; }
  long unconverged() const { return unconverged_; }
  long taken_back() const { return taken_back_; }  // windows that were tried in vain before shorter ones
  double work_gap() const { return work_gap_; }
  /// Peaks of forces that stand alone, in words (history_metrics.hpp).
  const std::vector<std::string>& blows() const { return blows_; }
  /// "<probe>:<metric>" as last reported, for `judge`.
  const std::map<std::string, double>& probe_results() const { return results_; }

  /// The alarms that the participants have raised so far, the earliest first.
  std::vector<RaisedAlarm> alarms() const;

  Json json() const;

  /// Counts and sums so far, for a checkpoint; what the participants report comes back with them.
  void save(Archive&) const;
  void load(const Archive&);

 private:
  double contact_time() const;
  void drop_peaks_before_contact();
  void drop_peaks_of_the_start(const Table& history);
  void drop_peaks_of_round_off();
  std::string case_, tag_;
  double time_ = 0;
  long windows_ = 0, iterations_ = 0, unconverged_ = 0, taken_back_ = 0;
  int max_iterations_ = 0;
  double work_gap_ = 0;
  bool coupled_ = false;
  std::vector<std::string> probes_;  // in the order of their first mention
  std::vector<std::string> blows_;
  std::vector<std::string> of_history_;      // without a record: force.y, moment.z …
  std::map<std::string, std::string> unit_;  // of columns
  std::map<std::string, double> results_;
  std::map<std::string, double> fluid_, structure_;  // reserved monitors as last reported
};

/// As an entry of "compare" in summary.json.
Json json_of(const Verdict&);

/// User and system time of this process [s].
double cpu_seconds();

/// The compare blocks that apply to a case, evaluated during its run.
class ComparisonStatus {
 public:
  explicit ComparisonStatus(const CaseView&);
  /// What the blocks came to of which all metrics have become known since the last call.
  std::vector<Verdict> settle(const RunData& now);
  /// Every block as it stands.
  std::vector<Verdict> all(const RunData&) const;

 private:
  std::vector<CompareBlock> blocks_;
  std::vector<bool> settled_;  // of blocks_
};

}  // namespace strake
