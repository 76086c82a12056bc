#pragma once

#include "coupler/participant/start_ranks.hpp"
#include "proto/ranks/communicator.hpp"

#include <functional>
#include <memory>

namespace strake {

/// The main of one rank, which a launcher has started. `build` makes the participant of a rank;
/// `program.declare` has run before.
int ranks_main(int argc, char** argv, const RankedProgram&,
               const std::function<std::unique_ptr<Participant>(const Setup&, Communicator&)>& build);

}  // namespace strake
