#pragma once

#include <filesystem>

namespace strake {
class CaseFile;
}

namespace strake::fluid {

/// Reads [fluid] of a case whose fluid is the record of an earlier run. Returns the folder of that run.
/// Throws Error(case_file) where there is none.
std::filesystem::path read_replayed_run(CaseFile&);

}  // namespace strake::fluid
