#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

class CaseFile;

/// Finds the case or study that a user names. A path, and a file that is there, are taken as they are. A name
/// alone, such as "plate_entry", is plate_entry.toml of the current folder, else Strake's own case of that
/// name. Error(case_file) for a name that is neither, with the nearest one.
std::filesystem::path find_case(const std::filesystem::path& named);

/// Reads the file of a case. Error(case_file) for a study, which names a case and what varies.
CaseFile load_no_study(const std::filesystem::path&, const std::vector<std::string>& sets);

/// Throws Error(case_file) for the file of a study. Passes over what is no file.
void refuse_study(const std::filesystem::path&);

/// Folder of Strake's own cases: share/strake/cases of an installation, or cases of the source tree above a
/// build. Empty if there is none.
std::filesystem::path cases_folder();

/// Names of the cases and studies in a folder, in order: NAME.toml, and NAME/NAME.toml with what it needs
/// beside it.
std::vector<std::string> case_names(const std::filesystem::path& folder);

}  // namespace strake
