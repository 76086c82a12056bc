#pragma once

#include "fluid/parameters/parameters.hpp"
#include "fluid/particles/state.hpp"
#include "proto/interface.hpp"

namespace strake::fluid {

/// Makes water and tank as `fill`, without the water that a submerged body displaces. With fluid.submerged as
/// many particles are left out as cells fit into the body under water: those whose cells it covers most.
/// Water that is then nearer than 0.3 l0 to a face is put there. On a face along the lattice that is the
/// water inside. `pack_around` moves the rest to even distances. In volume coupling the result is that of
/// `fill`.
template <int dim>
State<dim> fill_around(const Parameters&, const InterfaceMesh& body);

}  // namespace strake::fluid
