#pragma once

#include "structure/body/solid.hpp"

#include <utility>

namespace strake::structure {

/// Cells of a solid that lie over one another.
struct CellOverlaps {
  Eigen::Index cells = 0;                           // whose middle is inside another
  std::pair<int, int> first = {-1, -1};             // such a cell and another; the lowest numbers
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // the middle of one, inside the other [m]
};

/// Counts the cells whose middle lies inside another cell.
///
/// The middle of a sound cell is the mean of its corners. The plane of a side that two cells share divides
/// their middles, however bent the side is. So cells that meet along sides do not count. Cells that reach
/// into one another by less than half their size are not found. Cost: n log n for n cells.
CellOverlaps find_overlaps(const Solid&);

}  // namespace strake::structure
