#pragma once

#include <string>

namespace strake {

/// The version of Strake: "0.1.0".
std::string strake_version();
/// The commit of the sources of this build: "1a2b3c4d5e6f"; "unknown" where they were no git checkout.
std::string strake_commit();
/// The day of that commit, "2026-11-25"; empty where it is unknown.
std::string build_date();
/// Commit, day and libraries as `--version` prints them, a line each.
std::string build_text();
/// Versions of the libraries that the build found: "Eigen 3.4.0, deal.II 9.4.1, HDF5 1.10.8, …".
std::string library_versions();

}  // namespace strake
