#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads structure.loaded_faces, or structure.wet, its name before version 0.2. Throws Error(case_file) for a
/// face that the body has not got.
void read_loaded_faces(CaseTable structure, bool only_declares, Parameters&);

}  // namespace strake::structure
