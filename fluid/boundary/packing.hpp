#pragma once

#include "fluid/geometry/tank_shape.hpp"
#include "fluid/particles/state.hpp"

#include <vector>

namespace strake::fluid {

/// What all packings have in common: A (0.1 is slower, 0.4 oscillates), and in l0 the longest move, the
/// largest move at which all has settled, and the distance from the water's level up to which rows keep their
/// height.
inline constexpr double packing_strength = 0.2, longest_move = 0.1, settled_move = 1e-3, level_row = 0.75;

/// Moves the places of a full tank beside walls that cut through the lattice. The method is particle packing
/// (Colagrossi, Bouscasse, Antuono & Marrone 2012). All places within 8 l0 of such a wall move by
///   δr_i = −A l0² ∇C_i, ∇C_i = (d/n0) Σ_j w r_ij/r²,
/// summed over places and wall layers, until the largest move is below 0.1 % of l0 (at most 300 rounds). The
/// lattice beyond does not move. An open side is closed by places of the lattice during the packing. The rows
/// beside the water's level [m] stay in their heights: uneven first rows would be waves at the start.
void pack(std::vector<Vector<2>>& places, const TankShape<2>&, const WallParticles<2>&, double spacing,
          double level);

}  // namespace strake::fluid
