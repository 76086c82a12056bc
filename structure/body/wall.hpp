#pragma once

#include "structure/body/solid.hpp"

namespace strake::structure {

/// Thickness of a body's walls [m]: that of the thinnest box; of a mesh the length inside the body along the
/// inner normal of its facets, such that a tenth of its boundary has less.
double wall_thickness(const Solid&);

/// The largest length that all distances between the planes of boxes are whole multiples of [m].
double common_measure(const Solid&);

/// The spacing of particles [m] for a body without one of its own: four layers through its walls, and forty
/// along its longest side. Of boxes it divides the distances between all sides, if at most ten layers do
/// that.
double particle_spacing(const Solid&);

}  // namespace strake::structure
