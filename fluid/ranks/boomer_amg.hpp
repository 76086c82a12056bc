#pragma once

#include "fluid/ranks/mpi_communicator.hpp"
#include "fluid/ranks/shared_grid.hpp"

#include <memory>

namespace strake::fluid {

/// Solves the grid's equation by one V-cycle of BoomerAMG of hypre, with symmetric sweeps.
std::unique_ptr<SharedGrid> boomer_amg(const MpiCommunicator&);

}  // namespace strake::fluid
