#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads [structure.plate]: length, thickness, place, angle, hollow [SI, deg] and supports.
void read_plate(CaseTable, Plate&);

/// Makes the polygon of a plate whose lower face is a parabola. Its 40 chords miss that by 0.0006 of its
/// depth. `structure` is the table [structure]. Throws Error(case_file) where the solver is not rigid, or the
/// plate is thinner than it is hollow.
void read_hollow_plate(CaseTable structure, Parameters&);

}  // namespace strake::structure
