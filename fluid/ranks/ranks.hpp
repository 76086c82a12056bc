#pragma once

#include "fluid/ranks/communicator.hpp"
#include "fluid/ranks/shared_grid.hpp"

#include <functional>
#include <memory>

namespace strake::fluid {

/// The ranks of a run, how the water is divided among them, and who solves the pressure's first grid. By
/// default there is one rank.
struct Ranks {
  Communicator* communicator = nullptr;
  Partition partition = {};
  /// Makes the solver of the grid's equation. Where it is empty, the first rank solves the whole pressure
  /// equation as on one rank: to the last bit, but no faster.
  std::function<std::unique_ptr<SharedGrid>()> shared_grid = {};
};

}  // namespace strake::fluid
