#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

namespace strake::fluid {

/// Reads the keys of [fluid] that describe the tank, the water at the start, the walls and the tank's motion.
/// `dimension` and `spacing` are known.
void read_tank(CaseTable fluid, const CommonKeys&, Parameters&);

/// Reads fluid.ranks and fluid.launcher.
void read_ranks(CaseTable fluid, Parameters&);

/// Refuses what is computed on one rank alone, and ranks with too few particles.
void check_ranks(const CaseTable& fluid, const Parameters&);

}  // namespace strake::fluid
