#pragma once

#include "coupler/participant/participant_main.hpp"
#include "proto/ranks/communicator.hpp"

#include <functional>
#include <memory>
#include <string>

namespace strake {

/// A solver program that may compute on several ranks. Its part of the case has the keys `ranks` and
/// `launcher`.
struct RankedProgram {
  Program program;                             // on one rank
  std::string on_ranks = {};                   // "strake-fluid-ranks"; empty: one rank alone
  std::function<int()> ranks = {};             // once `program.declare` has run
  std::function<std::string()> launcher = {};  // "mpirun -n {ranks}"
  /// Takes so many ranks and processors of one machine, and returns the threads that each rank computes with.
  std::function<int(int ranks, int processors)> share_processors = {};
};

/// Replaces this process by the launcher of the ranks that the case asks for. It returns 0 where the case has
/// one rank, is not read to take part in a run, or cannot be read: participant_main then says what is wrong.
/// Else it returns an exit code, after it has said why the launcher cannot be started.
int start_ranks(int argc, char** argv, const RankedProgram&);

/// The main of such a program: start_ranks, then participant_main.
int main_or_ranks(int argc, char** argv, const RankedProgram&);

/// The main of one rank, which a launcher has started. `build` makes the participant of a rank;
/// `program.declare` has run before.
int ranks_main(int argc, char** argv, const RankedProgram&,
               const std::function<std::unique_ptr<Participant>(const Setup&, Communicator&)>& build);

}  // namespace strake
