#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Refuses a body whose smallest box leaves the box around fluid.tank by more than half a spacing. The fluid
/// refuses what leaves its walls by less, when it is built; this answers before anything is built. A mesh
/// that is far larger than the tank is told to be in mm.
void refuse_outside_tank(const CaseFile&, const CaseTable& structure, const CommonKeys&, const Parameters&);

}  // namespace strake::structure
