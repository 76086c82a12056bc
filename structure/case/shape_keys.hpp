#pragma once

#include "proto/case/case_file.hpp"
#include "structure/body/parameters.hpp"

namespace strake::structure {

/// Reads the one shape of [structure]: plate, outline, wedge, cylinder or sphere, and in three dimensions how
/// far it reaches along z. Throws Error(case_file) for a shape that no body can have.
void read_shape(const CaseFile&, CaseTable structure, Parameters&);

/// Reads how a rigid body, or the frame of an elastic body's supports, moves: mass and inertia, motion by a
/// table, turning, freedom; checks them against one another.
void read_body(const CaseFile&, CaseTable structure, const CommonKeys&, Parameters&);

/// Reads [structure.initial_velocity] of an elastic body.
void read_initial_velocity(const CaseFile&, CaseTable structure, Parameters&);

}  // namespace strake::structure
