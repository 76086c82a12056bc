#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads structure.ranks and structure.launcher.
void read_ranks(CaseTable structure, Parameters&);

/// Refuses what is computed on one rank alone.
void check_ranks(const CaseTable& structure, const Parameters&);

}  // namespace strake::structure
