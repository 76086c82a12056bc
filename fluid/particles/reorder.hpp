#pragma once

#include "fluid/particles/state.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Interval at which the water is sorted by its cells [steps]. It is sorted before such a step and nowhere
/// else, so that the order follows from the state alone: a rewound or restarted run sorts where the first one
/// did.
inline constexpr std::int64_t reorder_interval = 50;
inline bool reorder_due(std::int64_t step) {
  return step % reorder_interval == 0;
}

/// Returns, for each place k, the old place of the particle that moves there. The order is that of cells of
/// width `size` [m] along a Z-order curve. Particles near in space are then near in memory in every
/// direction. Within a cell the old order stays.
template <int dim>
std::vector<std::int32_t> cell_order(const Eigen::Ref<const Vectors<dim>>& position, double size);

/// Returns the number of the cell of each particle along that curve. low: corner of the first cell [m].
template <int dim>
std::vector<std::uint64_t> cells_along_curve(const Eigen::Ref<const Vectors<dim>>& position,
                                             const Vector<dim>& low, double size);

/// Sorts the first order.size() particles of every array of the state in that order. State::id identifies a
/// particle. The others, walls and bodies, keep their places.
template <int dim>
void reorder(State<dim>&, std::span<const std::int32_t> order);

}  // namespace strake::fluid
