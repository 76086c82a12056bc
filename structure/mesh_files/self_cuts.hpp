#pragma once

#include "structure/body/closed_surface.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>

namespace strake::structure {

/// Where a surface goes through itself.
struct SelfCuts {
  std::size_t pairs = 0;                            // of triangles that cut one another
  std::array<Eigen::Index, 2> first;                // such a pair, the one with the lowest numbers
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // where an edge of one goes through the other
};

/// Finds the pairs of triangles of which an edge of one goes through the other, more than `slack` inside
/// its border and on both sides. Triangles that touch, lie in one plane or share an edge are no such pair. A
/// tree of boxes around the triangles finds the candidates.
SelfCuts find_self_cuts(const ClosedSurface&, double slack);

}  // namespace strake::structure
