#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "proto/interface.hpp"

namespace strake::fluid {

/// Makes water and tank as `fill`, without the water that a submerged body displaces. With fluid.submerged
/// the water inside the body's surface at the start, and within 0.25 l0 of it, is left out. On a face along
/// the lattice this is the body's volume. In volume coupling the result is that of `fill`.
template <int dim>
State<dim> fill_around(const Parameters&, const InterfaceMesh& body);

}  // namespace strake::fluid
