#pragma once

#include "proto/ranks/communicator.hpp"
#include "structure/body/size.hpp"
#include "structure/deck/model.hpp"
#include "structure/solver/solver.hpp"

#include <memory>

namespace strake::structure::fem {

/// Makes the finite-element solver of a case, behind its interface, so that callers compile nothing of it.
/// On several ranks all of them make it, and call its functions together.
std::unique_ptr<Solver> make_solver(const Parameters&, Communicator* ranks = nullptr);

/// Exports the model that the finite-element solver of a case would use: its mesh, supports and loads. It
/// includes the places of the interface's points and of the structure's probes in the mesh.
deck::Model model(const Parameters&, const std::vector<ProbeKeys>&);

/// Cells, the unknowns in their nodes, and the points of the interface, for each of which cells are searched.
SizeEstimates sizes(const Parameters&);

}  // namespace strake::structure::fem
