#pragma once

#include "coupler/compare/compare_block.hpp"

#include <vector>

namespace strake {

class CaseFile;

/// Declares and reads every [[compare]] table; a reference file is read and must be finite throughout.
/// Throws Error(case_file) with its place.
std::vector<CompareBlock> read_compare_blocks(CaseFile&);

}  // namespace strake
