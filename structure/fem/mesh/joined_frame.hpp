#pragma once

#include "proto/interface.hpp"
#include "structure/fem/mesh/recovery.hpp"

namespace strake::structure::fem {

/// Joins the frames of all ranks on the first one: points and cells as they are on one rank. The others get
/// an empty frame. Points of `own` are the pairs of the recovery, and each cell of the mesh has as many
/// pieces.
template <int dim>
Frame joined_frame(const Frame& own, const Recovery<dim>&, const Mesh<dim>&);

}  // namespace strake::structure::fem
