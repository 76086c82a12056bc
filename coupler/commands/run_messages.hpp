#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/run/run_log.hpp"
#include "coupler/run/session.hpp"
#include "coupler/summary/notes.hpp"
#include "coupler/summary/summary.hpp"
#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace strake {

/// What strake run tells, and where.

std::unique_ptr<Reporter> reporter_of(const RunOptions&);

/// What the run tells: to the console, and to its log once that is open.
struct RunMessages {
  Reporter& reporter;
  std::shared_ptr<spdlog::logger> log = {};
  WaitLog wait_log = {};
  ConsoleLoss console = {};

  void note(const std::string& line) const {
    if (log) log->info(line);
    reporter.note(line);
  }
  void warn(const std::string& line) const {
    if (log) log->warn(line);
    reporter.warning(line);
  }
  void alarm(const std::string& line) const {
    if (log) log->error(fmt::format("alarm: {}", line));
    reporter.alarm(line);
  }
  void wait(const Awaited& whom, double elapsed) {
    if (const std::string line = wait_log.line(whom); log && !line.empty()) log->info(line);
    reporter.wait(whom, elapsed);
  }
};

/// What the participants' monitors say while a run goes on: failure, alarms, reads of preCICE's solvers,
/// values that are no numbers.
/// Each is told once; what happened up to `since` [s] was told before a resume.
class MonitorNotes {
 public:
  MonitorNotes(const CaseView&, double since, const std::vector<Column>&);  // of the session
  void tell(const WindowReport&, const RunMessages&);

 private:
  FailureNotes failure_;
  AlarmNotes alarms_;
  PreciceNotes precice_;
  EmptyCellNotes empty_;
  std::vector<std::string> users_;  // sides whose program is a user's
  bool several_;                    // bodies
};

/// The head of console and log, before the first window. history: the columns of its file.
RunHeader header_of(const CaseView&, Session&, const RunPlan&, const std::filesystem::path& folder,
                    const std::vector<Column>& history, bool resumed);

/// Adds to the error that stopped a run the checkpoint to resume from, if there is one, and the loss.
/// checkpoint: the latest, as the user would type it; empty: none. saved: its content.
/// cannot_resume: why there will never be one, if that is so.
Error with_resume_hint(const Error&, const std::filesystem::path& checkpoint, const LoopState& saved,
                       const Summary&, const std::string& cannot_resume = {});

/// [s] of the first contact that each sensor has seen, by its name: `compare` counts from there.
Json contact_times(const Summary&);

/// How the run ended, for its closing lines. The files of fields are those that lie in the folder.
RunEnd end_of(ExitCode, const Summary&, const std::filesystem::path& folder, const Profile*);

}  // namespace strake
