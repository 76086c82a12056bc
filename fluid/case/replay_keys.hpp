#pragma once

#include <filesystem>

namespace strake {
class CaseFile;
}

namespace strake::fluid {

struct ReplayedRun {
  std::filesystem::path folder;
  double end_time = 0;  // [s] of the run that plays it
};

/// Reads [fluid] of a case whose fluid is the record of an earlier run. Throws Error(case_file) where there
/// is none.
ReplayedRun read_replayed_run(CaseFile&);

}  // namespace strake::fluid
