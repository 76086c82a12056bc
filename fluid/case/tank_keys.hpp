#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

namespace strake::fluid {

/// Reads the keys of [fluid] that describe the tank, the water at the start, the walls and the tank's motion.
/// `dimension` and `spacing` are known.
void read_tank(CaseTable fluid, const CommonKeys&, Parameters&);

}  // namespace strake::fluid
