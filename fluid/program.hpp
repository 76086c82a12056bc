#pragma once

#include "coupler/participant/participant_main.hpp"
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
  /// What participant_main needs. This object must live as long.
  Program program();
  int ranks() const { return parameters_.ranks; }
  /// Line that starts that many ranks, without the program: "mpirun -n 4".
  const std::string& launcher() const { return parameters_.launcher; }

 private:
  CommonKeys common_;
  Parameters parameters_;
};

}  // namespace strake::fluid
