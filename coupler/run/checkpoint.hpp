#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "coupler/run/session.hpp"
#include "coupler/summary/summary.hpp"

#include <filesystem>
#include <functional>
#include <string>

namespace strake {

/// Checkpoints of a run: checkpoint/000420/{fluid,structure,coupler}.h5 with their `checksums`, and the link
/// `latest`. The link is renamed into place last, so that a checkpoint that `latest` names is complete, also
/// after a power cut. Two are kept, so that there is another when a disk damages one. In a copied run
/// `latest` may be a folder, a copy of the checkpoint beside it. It is never read, and the next link replaces
/// it.
class Checkpoints {
 public:
  explicit Checkpoints(const std::filesystem::path& run_folder);  // absolute

  /// What is committed, of the participants, the scheme, the loop and the summary.
  void write(Session&, const WindowLoop&, const Summary&);
  /// Seals the checkpoint of that number, waits until it is on the disk, and names it `latest` in one step.
  void complete(const std::string& number) const;
  /// The checkpoint to resume from: the latest, or the one before if that is damaged, which `say` reports.
  /// Throws Error(command_line) when there is none, Error(case_file) when none is complete.
  std::filesystem::path choose(const std::function<void(const std::string&)>& say) const;
  /// Resumes all participants from that checkpoint and drops later ones; returns the plan that continues from
  /// there.
  RunPlan resume(const std::filesystem::path& chosen, Session&, Summary&);
  /// After which window that checkpoint was taken.
  static long window_of(const std::filesystem::path& checkpoint);
  /// The last one written, absolute; empty while there is none.
  std::filesystem::path latest() const;

 private:
  void name_latest(const std::string& number) const;
  void forget(const std::filesystem::path& later_than) const;
  void forget_old() const;
  std::filesystem::path folder_;
};

/// The --set strings of a run that goes on, with those that keep the defaults it began with. The default
/// window follows from end_time, which may change, and runs of an older version had no default probes.
std::vector<std::string> settled_sets(const std::filesystem::path& case_file, std::vector<std::string> sets,
                                      const std::filesystem::path& run_folder);

/// Throws Error(command_line) when `who_cannot` says that a participant cannot save its state
/// (Session::cannot_resume, or that of the run before); empty: they can.
void check_can_resume(const std::string& who_cannot, const std::filesystem::path& run_folder);
/// Throws Error(command_line) when the case means something else than it did when the run began. What only
/// says how long, how often and how fast may change.
void check_same_case(const CaseView&, const std::filesystem::path& run_folder);

/// Throws Error(command_line) when the case ends before the run does, or has no window left to compute. A
/// resume from this checkpoint would drop rows, or end with a summary of nothing.
void check_end_time(const CaseView&, const std::filesystem::path& run_folder,
                    const std::filesystem::path& checkpoint);

/// The name of the file that `write_checksums` writes.
inline constexpr const char* checksums_name = "checksums";

/// Writes `checksums` into a folder: size and BLAKE2b of every file in it. It is written last, when all files
/// are on the disk, so that a folder with it is complete. Throws Error(cannot_write).
void write_checksums(const std::filesystem::path& folder);

/// Describes the damage to a folder with checksums ("fluid.h5 holds 100 bytes, not 20480"). Empty if every
/// file is unchanged.
std::string damage(const std::filesystem::path& folder);

}  // namespace strake
