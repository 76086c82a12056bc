#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

class CaseFile;

/// Keys that a side has where its solver is a program of the user's ("./solver").
struct ForeignKeys {
  /// True if `arguments` is given: it is then the whole command line, and --connect … stays away.
  bool own_command_line = false;
  std::vector<std::string> arguments;
  std::filesystem::path folder;  // absolute, where the program is started; empty: where strake was called
  /// For a solver with a preCICE adapter: what its names of data mean, "Force=force". It gets them in the
  /// variable STRAKE_PRECICE_NAMES. Empty: that of the user's environment. Strake's own solvers use them in a
  /// preCICE run.
  std::vector<std::string> precice_names;
  bool adapted = false;                  // solver = "precice": from the table `precice`
  std::filesystem::path precice_config;  // absolute; empty: names are not looked up
  /// Of a structure: mesh of its wet surface, for a program that sends its points alone; empty: it sends
  /// faces.
  std::filesystem::path surface;
};

/// Declares and reads those keys of the table `side` ("fluid" | "structure"). With one of Strake's solvers it
/// refuses them but for precice_names: Error(case_file). With solver = "precice" the keys come from the
/// side's table `precice`, and `solver` becomes the path of the program.
ForeignKeys read_foreign(CaseFile&, const std::string& side, std::string& solver);

}  // namespace strake
