#pragma once

#include "fluid/parameters/parameters.hpp"
#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"

namespace strake::fluid {

/// The keys of [fluid] that say where the tank and the water are, what the walls do to the water and how the
/// tank moves. dimension and spacing are known.
void read_tank(CaseTable fluid, const CommonKeys&, Parameters&);

}  // namespace strake::fluid
