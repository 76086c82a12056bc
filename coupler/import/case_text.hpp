#pragma once

#include "coupler/import/imported_run.hpp"

#include <filesystem>
#include <string>

namespace strake {

/// The case file of an imported run. Each setting has a comment that says where it comes from. folder: that
/// in which the programs are started, as it stands in the case file.
std::string case_text(const ImportedRun&, const std::string& folder);

}  // namespace strake
