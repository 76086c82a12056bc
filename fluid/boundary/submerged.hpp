#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "proto/interface.hpp"

namespace strake::fluid {

/// Water and tank as `fill` makes them; with fluid.submerged the water gives way to the body's surface where
/// it stands at the start, so far that the volume it leaves is the body's. Volume coupling: `fill`.
template <int dim>
State<dim> fill_around(const Parameters&, const InterfaceMesh& body);

}  // namespace strake::fluid
