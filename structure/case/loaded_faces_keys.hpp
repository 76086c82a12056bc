#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads structure.wet. Throws Error(case_file) for a face that the body has not got.
void read_wet(CaseTable structure, bool only_declares, Parameters&);

}  // namespace strake::structure
