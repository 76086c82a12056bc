#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

#include <Eigen/Core>

#include <vector>

namespace strake::structure {

/// Reads structure.offsets and structure.station: one section of a table of offsets, mirrored at the middle
/// plane. Returns its corners (half breadth, height) [m], counter-clockwise from the keel, the top closed by
/// a deck. Empty: the keys are not given. Throws Error(case_file) with the table's file and row.
std::vector<Eigen::Vector2d> read_offsets(const CaseFile&, CaseTable structure);

}  // namespace strake::structure
