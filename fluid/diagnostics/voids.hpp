#pragma once

#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/state.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace strake::fluid {

/// Counts surface particles deeper than 5 l0 below the outer surface. They lie around air that waves have
/// enclosed, or (`internal_voids`) where the water has separated inside. The outer surface borders on the
/// outer air. This is the space farther than about 1.5 l0 from every particle that is connected with the
/// space above all particles. Under a lid it is the largest such space. Computed on cells of l0, so that the
/// depth is known to within one. water: numbers of the particles that have not left the tank. Nothing where
/// the box around all particles has too many cells, 2.6e11 in space.
struct Voids {
  std::int64_t all = 0, internal_voids = 0;
};
template <int dim>
std::optional<Voids> count_voids(const State<dim>&, std::span<const std::int64_t> water, double spacing,
                                 bool open_top);

/// Updates State::air_connected after a step. A surface particle is connected with air if it was so before,
/// if a surface particle near it was, or if it has no neighbour. One that appears with none near it lies at
/// an internal void. near: rows of about 2 l0.
template <int dim>
void follow_air(State<dim>&, const Neighbours& near, std::int64_t water, std::vector<std::uint8_t>& scratch);

}  // namespace strake::fluid
