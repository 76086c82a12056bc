#pragma once

#include "fluid/pressure_solver/pressure_system.hpp"
#include "fluid/pressure_solver/ranked_unknowns.hpp"

namespace strake::fluid {

/// Does what `close_sealed_blocks` does on one rank, for blocks that may lie on several. All ranks call it
/// together.
template <int dim>
int close_sealed_blocks(PressureSystem&, const RankedUnknowns<dim>&);

}  // namespace strake::fluid
