#pragma once

#include "coupler/new_case/kinds.hpp"

#include <string>

namespace strake {

/// Particles of water and walls that a scene has, about.
double particles_of(const NewScene&);
/// Spacing [m] of two digits with which a scene in space has about 100 000 particles. Reads the lengths of
/// tank and water alone.
double spacing_in_space(const NewScene&);
/// Says what half the spacing costs: "7.2 times the particles, 14 times the time".
std::string cost_of_half(const NewScene&);

}  // namespace strake
