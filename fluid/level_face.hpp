#pragma once

#include "proto/interface.hpp"

namespace strake::fluid {

/// The part of a body's faces that lies level over the water: normals within one degree of straight down, all
/// points at or above `water_level` [m, along y]. Width [m] in the plane, area [m²] in space; 0 without
/// faces.
///
/// The first pressure of such a face is ρ c V and lasts some a/c (von Karman 1929), a the half width. Only
/// steps that resolve sound show it. Where a face is inclined, contact spreads more slowly than sound.
double level_face(const InterfaceMesh&, double water_level);

}  // namespace strake::fluid
