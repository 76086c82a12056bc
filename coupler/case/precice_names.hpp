#pragma once

#include "proto/case/foreign_keys.hpp"

#include <string>

namespace strake {

/// Looks up the names of data that [SIDE.precice] gives in its preCICE configuration. Error(case_file) for
/// one that is not there, and for a configuration that cannot be read. Does nothing without a configuration.
void check_precice_names(const std::string& side, const ForeignKeys&);

}  // namespace strake
