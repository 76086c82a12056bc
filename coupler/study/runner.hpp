#pragma once

#include "coupler/study/plan.hpp"
#include "proto/error.hpp"

#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace strake {
class StopRequest;
}

namespace strake::study {

/// How one run of a study stands.
struct Outcome {
  enum class State { missing, done, failed };
  State state = State::missing;
  int exit_code = -1;            // of `strake run`
  double seconds = 0;            // wall time of the run
  std::filesystem::path folder;  // of the run
  std::string problem;           // of a failed run: the first lines of its error
};
std::string to_text(Outcome::State);

struct RunnerOptions {
  std::filesystem::path folder;  // of the study: runs, their logs and state.json
  int jobs = 1;                  // runs at once
  bool again = false;            // what is done is run anew
  std::FILE* console = nullptr;  // progress; null: none
};

/// The command line of a run, as a user would type it (without the program's name in front).
std::vector<std::string> arguments_of(const Plan&, const PlannedRun&, const std::filesystem::path& folder);
std::filesystem::path folder_of(const Plan&, const PlannedRun&, const std::filesystem::path& study_folder);

/// Starts every run that is not done, `jobs` at once. Each is a `strake run` of its own with one thread (or
/// as many as its case says). Runs that an earlier study of the same case and keys finished are skipped;
/// unfinished ones resume from their checkpoint. A run that fails does not stop the others; one that replays
/// a failed run is left out. On Ctrl-C every run keeps its state and the outcomes so far are returned.
std::map<std::string, Outcome> perform(const Plan&, const RunnerOptions&, const StopRequest&);

}  // namespace strake::study
