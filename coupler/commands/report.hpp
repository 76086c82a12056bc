#pragma once

#include "proto/error.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

struct ReportOptions {
  std::vector<std::filesystem::path> what;  // run folders, or one folder of a study
  std::filesystem::path out;                // empty: report.html in the first folder
  std::vector<double> at;                   // [s] of the pictures
};
/// Writes one page about runs, or about a study.
ExitCode write_report(const ReportOptions&);

}  // namespace strake
