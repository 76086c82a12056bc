#pragma once

#include "coupler/participant/start_ranks.hpp"
#include "fluid/parameters/parameters.hpp"
#include "fluid/ranks/ranks.hpp"
#include "proto/case/case_keys.hpp"

#include <memory>

namespace strake::fluid {

/// The fluid as a program: its keys, and its participant on one or several ranks.
class FluidProgram {
 public:
  /// Reads, so declares, all keys of the fluid.
  void declare(CaseFile&);
  /// Builds the participant of one rank. `declare` has run.
  std::unique_ptr<Participant> build(const Setup&, const Ranks& ranks = {}) const;
  /// What start_ranks and participant_main need. This object must live as long.
  RankedProgram program();

 private:
  CommonKeys common_;
  Parameters parameters_;
};

}  // namespace strake::fluid
