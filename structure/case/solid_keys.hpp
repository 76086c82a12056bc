#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads [[structure.box]], the parts of an elastic body, and makes the solid of whatever shape was given;
/// after read_shape and the material of [structure.material], which is that of parts without one. Throws
/// Error(case_file) for a body that hangs in pieces, a support that holds nothing, and so on.
void read_solid(const CaseFile&, CaseTable structure, Parameters&);

/// Reads a table of material keys over the values that stand in the material.
void read_material(CaseTable, Material&);

}  // namespace strake::structure
