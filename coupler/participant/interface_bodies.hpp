#pragma once

#include "proto/interface.hpp"

#include <vector>

namespace strake {

/// Where each of several bodies begins in a recorded interface ("body.left": first point, first face), in
/// order; none for one structure.
std::vector<MeshPart> parts_in(const Archive&);

}  // namespace strake
