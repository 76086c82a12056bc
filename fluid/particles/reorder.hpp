#pragma once

#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Water is put in the order of its cells so often [steps]. Before such a step and nowhere else, so that the
/// order follows from the state alone: a rewound or restarted run sorts where the first one did.
inline constexpr std::int64_t reorder_interval = 50;
inline bool reorder_due(std::int64_t step) {
  return step % reorder_interval == 0;
}

/// Old place of the particle that comes to place k: cells of width `size` [m] along a Z-order curve, so that
/// what is near in space is near in memory in every direction; within a cell the old order stays.
template <int dim>
std::vector<std::int32_t> cell_order(const Eigen::Ref<const Vectors<dim>>& position, double size);

/// Puts the first order.size() particles of every array of the state in that order; identity is State::id.
/// The others, walls and bodies, keep their places.
template <int dim>
void reorder(State<dim>&, std::span<const std::int32_t> order);

}  // namespace strake::fluid
