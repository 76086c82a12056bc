#pragma once

#include "proto/participant.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// Where the water's body comes from in a preCICE run, whose partner tells a fluid no mesh.
struct BodySource {
  std::string solver;             // structure.solver of the case
  std::filesystem::path surface;  // of structure.surface or structure.precice.surface; empty: none
  std::filesystem::path case_file;
  std::vector<std::string> sets;
};

/// The body that a fluid meets: the surface file if the case names one, else what the case's structure
/// program prints with --interface. Sets partner_mesh and partner_initial of a Setup. dimension: 2 or 3, of
/// the configuration's mesh. Error(case_file) for a case without a body, a file without faces or of one-sided
/// faces, and what the program refuses.
Setup setup_with_body(const BodySource&, int dimension);

}  // namespace strake
