#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"

namespace strake::fluid {

/// Reads fluid.ranks and fluid.launcher.
void read_ranks(CaseTable fluid, Parameters&);

/// Refuses what is computed on one rank alone, and ranks with too few particles.
void check_ranks(const CaseTable& fluid, const Parameters&);

}  // namespace strake::fluid
