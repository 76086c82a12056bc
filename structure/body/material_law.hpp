#pragma once

#include "structure/body/solid.hpp"

#include <string>
#include <vector>

namespace strake::structure {

/// Names the material laws of a body's parts. Examples: "neo-Hookean", or, if they differ, "linear elasticity
/// (rib) and Saint Venant-Kirchhoff (plate, deck)".
std::string material_law(const std::vector<Part>&);
/// Whether every part is linear: small strains, the reference configuration throughout.
bool all_linear(const std::vector<Part>&);

}  // namespace strake::structure
