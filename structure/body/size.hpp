#pragma once

#include "proto/case/size_limit.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// What a body makes in each of the structure programs, from its shape and the spacings alone.

/// Points of the interface. `cells`: cells of the mesh that are searched for each point.
SizeEstimate surface_size(const Parameters&, double cells = 0);
/// Particles and their bonds; and the samples of a body from a mesh file, of which the lattice is made.
SizeEstimates lattice_sizes(const Parameters&);

/// Of the kinds whose shape is not divided further: rigid and replay.
SizeEstimates surface_sizes(const Parameters&);
/// Of the particle structure.
SizeEstimates particle_sizes(const Parameters&);

}  // namespace strake::structure
