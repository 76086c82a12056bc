#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "coupler/case_view.hpp"
#include "coupler/run_loop.hpp"
#include "coupler/session.hpp"
#include "coupler/summary.hpp"

namespace strake {

/// checkpoint/000420/{fluid,structure,coupler}.h5 of a run, and the link `latest`, which is renamed into
/// place last: a checkpoint that `latest` names is whole. Two are kept.
class Checkpoints {
 public:
  explicit Checkpoints(const std::filesystem::path& run_folder);  // absolute

  /// What is committed, of the participants, the scheme, the loop and the summary.
  void write(Session&, const RunLoop&, const Summary&);
  /// Takes everybody back to the latest checkpoint; returns the plan that goes on from there. Throws
  /// Error(command_line) when there is none.
  RunPlan resume(Session&, Summary&);
  /// runs/plate_entry/checkpoint/000420, for messages; empty while there is none.
  std::filesystem::path latest() const;

 private:
  void forget_old() const;
  std::filesystem::path folder_;
};

/// Throws Error(command_line) when the case means something else than it did when the run began. What only
/// says how long, how often and how fast may change.
void check_same_case(const CaseView&, const std::filesystem::path& run_folder);

}  // namespace strake
