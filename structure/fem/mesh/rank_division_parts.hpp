#pragma once

#include "structure/fem/mesh/rank_division.hpp"

#include <deal.II/base/partitioner.h>

#include <vector>

namespace strake::structure::fem {

/// What a division is made of. Ranks are the processes of MPI_COMM_WORLD.
struct RankDivision::Parts {
  Communicator& communicator;
  dealii::Utilities::MPI::Partitioner unknowns;  // own ones and ghosts
  std::vector<int> on_one_rank;                  // number of each unknown in the body on one rank
};

}  // namespace strake::structure::fem
