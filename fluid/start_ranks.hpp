#pragma once

namespace strake::fluid {

class FluidProgram;

/// Replaces this process by the launcher of the ranks that the case asks for. It returns 0 where the case has
/// one rank, is not read to take part in a run, or cannot be read: participant_main then says what is wrong.
/// Else it returns an exit code, after it has said why the launcher cannot be started.
int start_ranks(int argc, char** argv, FluidProgram&);

}  // namespace strake::fluid
