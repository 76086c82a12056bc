#pragma once

#include "coupler/participant/start_ranks.hpp"
#include "proto/case/case_keys.hpp"
#include "structure/body/parameters.hpp"
#include "structure/solver/program.hpp"

#include <memory>

namespace strake::structure {

/// A structure solver as a program: its keys, and its participant on one or several ranks.
class StructureProgram {
 public:
  explicit StructureProgram(SolverProgram);
  /// What start_ranks and participant_main need. This object must live as long.
  RankedProgram program();
  /// Builds the participant of one rank. The keys have been read.
  std::unique_ptr<Participant> build(const Setup&, Communicator* ranks = nullptr);

 private:
  SolverProgram solver_;
  CommonKeys common_;
  Parameters parameters_;
};

}  // namespace strake::structure
