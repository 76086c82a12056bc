#pragma once

#include "coupler/watch/table_tail.hpp"
#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace strake::watch {

/// A process of a run on this machine, as the system's tables have it.
struct Process {
  std::string name;  // "coupler" | "fluid" | "structure"
  pid_t pid = 0;
  char state = '?';         // of /proc: R computing, S waiting, D disk, T stopped, Z ended
  long long started = 0;    // [ticks since the machine's start]: with the number, who it is
  double cpu_seconds = 0;   // user and system time so far
  double memory_bytes = 0;  // resident
};
/// "computing", "waiting", "stopped by a signal" …
std::string words_for_state(char state);

/// The participants that were started with this endpoint (run.json's), and the coupler that started them.
/// Asks the system, never the run. Empty where nothing is found.
std::vector<Process> processes_of(const std::string& endpoint);
/// What they do now, without looking through all others of the machine; false when one of them is gone.
bool refresh(std::vector<Process>&);

enum class State {
  starting,  // under way, no window done yet
  running,
  silent,  // under way, but nothing was written for a while
  finished,
  stopped,  // by Ctrl-C or SIGTERM
  failed,   // with an error of its own
  killed,   // no process runs it any more, and no end was recorded
  away      // on another machine: its processes cannot be tested from here
};
/// "running" …
std::string name_of(State);
/// Whether more may come.
constexpr bool open(State state) {
  return state == State::starting || state == State::running || state == State::silent ||
         state == State::away;
}

/// What can be said of a run at one moment. Times on the clock are seconds since 1970.
struct RunStatus {
  State state = State::starting;
  std::string words;               // the state as a sentence
  std::string error;               // of a failed run: where, problem and fix
  std::optional<int> exit_code;    // of the run
  double time = 0;                 // [s] simulated
  std::optional<double> end_time;  // [s] of the case
  long window = 0;                 // last committed
  std::optional<double> started;   // [s] on the clock
  double elapsed = 0;              // [s] since then, up to the end
  std::optional<double> left;      // [s] to the end at the pace of the last windows
  double silence = 0;              // [s] since a file of the run was last written
  std::vector<Process> processes;  // on this machine
};

/// State of a run from its files, updated again and again. Reads only what has changed; sends nothing to the
/// run and writes nothing.
class WatchedRun {
 public:
  /// Throws Error(command_line) where there is no such folder, Error(case_file) where it is not a run's.
  explicit WatchedRun(std::filesystem::path folder);

  const RunStatus& update();

  const std::filesystem::path& folder() const { return folder_; }
  std::string name() const;   // of the folder
  std::string title() const;  // of the case; the name where it has none
  const RunStatus& last() const { return status_; }
  const TableTail& history() const { return history_; }
  const TableTail& iterations() const { return iterations_; }
  const TableTail& timing() const { return timing_; }
  /// Values of case.toml by key ("fluid.spacing"); empty while there is none.
  const std::map<std::string, std::string>& keys() const { return keys_; }
  std::optional<double> number(const std::string& key) const;
  const Json& record() const { return record_; }    // run.json; null while there is none
  const Json& summary() const { return summary_; }  // summary.json; likewise
  /// Names of the case's probes, in its order.
  const std::vector<std::string>& probes() const { return probes_; }

 private:
  struct Stamp {
    std::int64_t size = -1, nanoseconds = 0;
    ino_t inode = 0;
    bool operator==(const Stamp&) const = default;
  };
  static Stamp stamp_of(const std::filesystem::path&);
  bool changed(const std::string& file);
  void find_processes();
  void read_case();
  bool under_way() const;
  double last_written() const;
  void judge();
  std::optional<double> time_left() const;

  std::filesystem::path folder_;
  TableTail history_, iterations_, timing_;
  std::map<std::string, Stamp> stamps_;
  std::map<std::string, std::string> keys_;
  std::vector<std::string> probes_;
  Json record_, summary_;
  std::chrono::steady_clock::time_point searched_{};  // for processes
  RunStatus status_;
};

/// The run folder under `runs` that was written to last. Throws Error(command_line) where there is none.
std::filesystem::path newest_run(const std::filesystem::path& runs);

}  // namespace strake::watch
