#pragma once

#include "proto/error.hpp"
#include "structure/fem/mesh/mesh.hpp"

namespace strake::structure::fem {

/// Statics need all rigid motions stopped: throws Error(case_file) otherwise.
template <int dim>
void require_constrained(const Mesh<dim>& mesh) {
  if (rigid_motions_left(mesh) > 0)
    throw Error(
        ExitCode::case_file, "structure.analysis = \"static\"",
        "without enough supports there is no equilibrium: the body can move or turn as a whole",
        "hold it: structure.plate.supports, the supports of a structure.box, or [[structure.support]]");
}

}  // namespace strake::structure::fem
