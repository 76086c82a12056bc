#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// A setting of the case file, and where it comes from ("line 30").
template <class T>
struct Stated {
  T value{};
  std::string from;
};

/// One participant of a preCICE configuration as a side of a case.
struct ImportedSide {
  Stated<std::string> participant;
  std::vector<std::string> meshes;  // those that it provides
  std::vector<std::string> sends;   // names of data
  std::vector<std::string> names;   // "Force=force", for both participants the same
};

/// coupling.surface.mapping. The radial part is meant with kind = "radial-basis" alone.
struct ImportedMapping {
  Stated<std::string> kind;
  std::string function, polynomial = "linear", solve = "partition";
  double support = 0;  // [m]
  int patch_points = 50;
  double overlap = 0.15;
};

/// coupling.surface.accelerator. The part for quasi-Newton is meant with kind = "iqn-ils" and "iqn-imvj".
struct ImportedAcceleration {
  Stated<std::string> kind;
  Stated<double> initial_relaxation;
  Stated<int> reused_windows, max_columns;
  Stated<double> filter;
  Stated<std::string> filter_kind;
  bool quasi_newton() const { return kind.value.starts_with("iqn"); }
};

/// Limits of the data that one participant sends; 0: not tested (coupler/coupling/convergence.hpp).
struct ImportedLimits {
  double relative = 0, absolute = 0, residual_relative = 0;
  std::string from;  // empty: the configuration has no measure of these data
  bool operator==(const ImportedLimits& other) const {
    return relative == other.relative && absolute == other.absolute &&
           residual_relative == other.residual_relative;
  }
};

/// How the two participants take turns, and for how long.
struct ImportedScheme {
  Stated<bool> parallel, implicit;
  Stated<double> window, end_time;  // [s]
  Stated<int> min_iterations, max_iterations;
  Stated<bool> strict;  // the run stops where a window has not converged
  ImportedLimits of_structure, of_fluid;
};

/// What a preCICE configuration asks for, in the words of a case file.
struct ImportedRun {
  std::filesystem::path file;
  ImportedSide fluid, structure;  // the first participant, the second
  ImportedMapping mapping;
  ImportedScheme scheme;
  ImportedAcceleration acceleration;
  std::vector<std::string> notes;  // what is left out, or has to be decided by the user
};

/// Reads a configuration of two participants. Error(case_file) with file:line:column names what Strake does
/// not have.
ImportedRun import_precice(const std::filesystem::path&);

/// The case file of an imported run. Each setting has a comment that says where it comes from. folder: that
/// in which the programs are started, as it stands in the case file.
std::string case_text(const ImportedRun&, const std::string& folder);

}  // namespace strake
