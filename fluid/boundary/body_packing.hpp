#pragma once

#include "fluid/boundary/boundary.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"

namespace strake::fluid {

/// Whether `pack_around` packs the water: a body stands in it at the start, with faces.
template <int dim>
bool water_is_packed(const Parameters&, const Boundary<dim>&);

/// Whether some of the water is packed at the start: on a body, or on walls that cut through the lattice.
template <int dim>
bool water_starts_packed(const Parameters&, const Boundary<dim>&);

/// Whether water at x ends within the radius [m] at another place than body, walls or level.
template <int dim>
bool beside_open_side(const Parameters&, const Boundary<dim>&, const Vector<dim>& x, double radius);

/// Moves the water that stands on a body at the start to even distances, without a gap (fluid/THEORY.md,
/// section 10.1). Places within 6 l0 of the body move by
///   δr_i = −A l0² ∇C_i, ∇C_i = (d/n0) Σ w r/r²
/// over water and layers, until the largest move is below 0.1 % of l0 (at most 200 rounds). The lattice
/// beyond does not move. The water's level is a mirror, and the first row under it moves along it alone.
/// Throws Error(case_file) where a stretch of faces gets no water, or water is pressed together (F67).
template <int dim>
void pack_around(const Parameters&, Boundary<dim>&, State<dim>&);

/// Makes all particles surface and all faces dry, as at the start of a run. Faces that packed water stands
/// on count as wet before: those of a body, and the walls of a tank off the lattice. About a body, and in a
/// tank whose water starts level, the pressure is ρg times the depth.
template <int dim>
void begin_at_rest(const Parameters&, const Boundary<dim>&, State<dim>&);

}  // namespace strake::fluid
