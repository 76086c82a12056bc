#pragma once

#include "coupler/participant/participant_main.hpp"

namespace strake {

/// Takes part in a preCICE run with the program's solver, to its end (--precice). Returns the exit code; an
/// Error is printed and, where the library is Strake's, reported to the coupler.
///
/// Throws Error before the run: Error(command_line) for options and the library, Error(case_file) for the
/// configuration and the case.
int run_in_precice(const ParticipantOptions&, const Program&);

}  // namespace strake
