#pragma once

#include "fluid/geometry/tank_shape.hpp"
#include "fluid/particles/state.hpp"

#include <vector>

namespace strake::fluid {

/// Settles the places of a full tank against walls that cut through the lattice, in the manner of particle
/// packing (Colagrossi, Bouscasse, Antuono & Marrone 2012): all within 8 l0 of such a wall follow
///   δr_i = −A l0² ∇C_i, ∇C_i = (d/n0) Σ_j w r_ij/r²,
/// over places and wall rows until what is left is a fraction of a percent of l0; the lattice beyond stands
/// still. An open side is closed by rows of the lattice while it lasts.
void pack(std::vector<Vector<2>>& places, const TankShape<2>&, const WallParticles<2>&, double spacing);

}  // namespace strake::fluid
