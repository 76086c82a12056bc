#pragma once

#include "fluid/ranks/shared_grid.hpp"
#include "proto/ranks/communicator.hpp"

#include <memory>

namespace strake::fluid {

/// Solves the grid's equation by one V-cycle of BoomerAMG of hypre, with symmetric sweeps.
std::unique_ptr<SharedGrid> boomer_amg(Communicator&);

}  // namespace strake::fluid
