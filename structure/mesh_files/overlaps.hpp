#pragma once

#include "structure/body/solid.hpp"

#include <utility>

namespace strake::structure {

/// Cells of a solid that lie over one another.
struct CellOverlaps {
  Eigen::Index cells = 0;                           // that reach into another
  std::pair<int, int> first = {-1, -1};             // such a cell and another; the lowest numbers
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // in the one, inside the other [m]
};

/// Counts the cells that have their middle, or the neighbourhood of a corner, inside another cell.
///
/// The middle M of a sound cell is the mean of its corners X. The other places are X + (M − X)/5. A place
/// counts where it lies behind the planes of all sides of both cells. The plane of a side that two cells
/// share divides them, however bent the side is. So cells that meet along sides do not count. Cells that
/// reach into one another by less than an eighth of their size are not found. Cost: n log n for n cells.
CellOverlaps find_overlaps(const Solid&);

}  // namespace strake::structure
