#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads the one shape of [structure]: plate, outline, wedge, cylinder or sphere. In three dimensions it
/// reads the extent along z too. Throws Error(case_file) for a shape that no body can have.
void read_shape(const CaseFile&, CaseTable structure, Parameters&);

/// Reads the motion of a rigid body, or of the frame of an elastic body's supports. It reads mass and
/// inertia, motion by a table, turning and freedom, and checks them against one another.
void read_body(const CaseFile&, CaseTable structure, const CommonKeys&, Parameters&);

/// Reads [structure.initial_velocity] of an elastic body.
void read_initial_velocity(const CaseFile&, CaseTable structure, Parameters&);

/// Reads structure.loaded_faces, or structure.wet, its name before version 0.2. Throws Error(case_file) for a
/// face that the body has not got.
void read_loaded_faces(CaseTable structure, bool only_declares, Parameters&);

}  // namespace strake::structure
