#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads [structure.fem]. A solid shell has other defaults: degree 1, one cell through the thickness.
void read_fem(CaseTable, FemKeys&);

/// Throws Error(case_file) where a solid shell is asked for and cannot be: in the plane, or of degree 2.
void check_fem(CaseTable, const Parameters&);

}  // namespace strake::structure
