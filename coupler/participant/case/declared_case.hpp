#pragma once

#include "coupler/participant/participant_main.hpp"
#include "proto/case/case_file.hpp"

#include <string>

namespace strake {

/// Throws Error(command_line) where an option that a mode needs is missing.
void require_option(bool condition, const std::string& option);

/// Declares all keys of this program, and checks that the machine's memory suffices. Error(case_file).
void declare_case(CaseFile&, const Program&);

/// The case of --case as this program sees it: of several bodies its own. Error(command_line) where --body is
/// missing or wrong.
CaseFile load_case(const ParticipantOptions&, const Program&);

/// The case of --case, read by everything that this program declares. Error(command_line) without --case,
/// Error(case_file) for what the program refuses.
CaseFile load_declared(const ParticipantOptions&, const Program&);

/// Takes part in a preCICE run with the program's solver, to its end (--precice). Returns the exit code; an
/// Error is printed and, where the library is Strake's, reported to the coupler.
///
/// Throws Error before the run: Error(command_line) for options and the library, Error(case_file) for the
/// configuration and the case.
int run_in_precice(const ParticipantOptions&, const Program&);

}  // namespace strake
