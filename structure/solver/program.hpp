#pragma once

#include "proto/case/case_keys.hpp"
#include "proto/case/size_limit.hpp"
#include "proto/ranks/communicator.hpp"
#include "structure/body/parameters.hpp"
#include "structure/solver/solver.hpp"

#include <functional>
#include <memory>
#include <string>

namespace strake {
struct DeckRequest;
}

namespace strake::structure {

/// What distinguishes one structure program from another. All have the same main.cpp; each links the one file
/// that defines `this_program`.
struct SolverProgram {
  std::string kind;  // "fem" | "particle" | "ccx" | "rigid" | "replay"
  std::function<std::unique_ptr<Solver>(const Parameters&)> build;
  /// What the body makes in this program, before it is built.
  std::function<SizeEstimates(const Parameters&)> sizes;
  double properties_cost = 1;  // of the natural frequencies, in times of the building
  /// Writes an input file for other programs, if the solver has a mesh that they can take. Returns the text
  /// for the user.
  std::function<std::string(const Parameters&, const CommonKeys&, const DeckRequest&)> export_deck = nullptr;
  /// Builds the solver of one of several ranks; empty: this kind has one.
  std::function<std::unique_ptr<Solver>(const Parameters&, Communicator&)> build_on_ranks = nullptr;
};
SolverProgram this_program();

}  // namespace strake::structure
