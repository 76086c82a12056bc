#pragma once

#include <cstdint>
#include <span>

#include "fluid/state.hpp"

namespace strake::fluid {

/// Water particles that are flagged as surface deeper than 5 l0 below the outer surface: holes that the
/// scheme has opened. The outer surface borders on the air, which is the space farther than 1.5 l0 or so from
/// every particle (water, walls and bodies) that hangs together with what lies above the tank, or, under a
/// lid, the largest such space. On cells of l0, so that the depth is known to within one. water: numbers of
/// the particles that have not left the tank.
template <int dim>
std::int64_t count_voids(const State<dim>&, std::span<const std::int64_t> water, double spacing,
                         bool open_top);

}  // namespace strake::fluid
