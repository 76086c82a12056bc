#pragma once

#include <vector>

#include "proto/case_keys.hpp"
#include "structure/deck/model.hpp"
#include "structure/parameters.hpp"

namespace strake::structure::fem {

/// What the finite-element solver of a case would compute with, for other programs: its mesh, supports and
/// loads, and how the interface's points and the structure's probes lie in it.
deck::Model model(const Parameters&, const std::vector<ProbeKeys>&);

}  // namespace strake::structure::fem
