#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads [[structure.box]], the parts of an elastic body, and builds the solid of the given shape. Called
/// after read_shape and after [structure.material], which is the material of parts without one. Throws
/// Error(case_file) for a body in separate pieces, a support that constrains nothing, and so on.
void read_solid(const CaseFile&, CaseTable structure, Parameters&);

/// Reads a table of material keys over the values that stand in the material.
void read_material(CaseTable, Material&);

}  // namespace strake::structure
