#pragma once

#include "proto/case/case_keys.hpp"
#include "structure/body/parameters.hpp"
#include "structure/deck/model.hpp"

#include <vector>

namespace strake::structure::fem {

/// What the finite-element solver of a case would compute with, for other programs: its mesh, supports and
/// loads, and how the interface's points and the structure's probes lie in it.
deck::Model model(const Parameters&, const std::vector<ProbeKeys>&);

}  // namespace strake::structure::fem
