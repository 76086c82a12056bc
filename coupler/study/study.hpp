#pragma once

#include "proto/error.hpp"

#include <filesystem>
#include <string>

namespace strake {

class StopRequest;

struct StudyOptions {
  std::filesystem::path file;           // study.toml
  std::filesystem::path runs = "runs";  // the study is runs/<study>
  int jobs = 0;                         // runs at once; 0: as the file says, else one for each core
  bool again = false;                   // also what is done
  bool list = false;                    // say what would be run
  bool strict = false;                  // exit 1 when a check fails
  bool quiet = false;
};

/// Runs a study and writes runs/<study>/study.csv (a line for each run) and study.json (that, checks, orders
/// of convergence, claims). Exit code of the first run that failed, else done (or 1 under `strict`).
ExitCode study_command(const StudyOptions&, const StopRequest&);

}  // namespace strake
