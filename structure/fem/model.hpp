#pragma once

#include "proto/case/case_keys.hpp"
#include "structure/body/parameters.hpp"
#include "structure/deck/model.hpp"

#include <vector>

namespace strake::structure::fem {

/// Exports the model that the finite-element solver of a case would use: its mesh, supports and loads. It
/// includes the places of the interface's points and of the structure's probes in the mesh.
deck::Model model(const Parameters&, const std::vector<ProbeKeys>&);

}  // namespace strake::structure::fem
