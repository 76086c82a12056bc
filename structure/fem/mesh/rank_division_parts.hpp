#pragma once

#include "structure/fem/mesh/rank_division.hpp"

#include <deal.II/base/partitioner.h>

#include <memory>
#include <vector>

namespace strake::structure::fem {

/// What a division is made of. Ranks are the processes of MPI_COMM_WORLD.
struct RankDivision::Parts {
  Communicator& communicator;
  std::shared_ptr<const dealii::Utilities::MPI::Partitioner> entries;  // own ones and ghosts
  std::vector<int> on_one_rank;  // number of each entry in the body on one rank
};

}  // namespace strake::structure::fem
