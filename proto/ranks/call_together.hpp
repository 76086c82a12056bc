#pragma once

#include "proto/ranks/mpi_communicator.hpp"

#include <functional>

namespace strake {

/// Makes a call on all ranks, and waits until it has ended on each of them. An exception on one rank becomes
/// an Error on all, which names the rank and the cause. What all ranks throw stays as it is: they have agreed
/// on it, and the first one tells the coupler.
///
/// A rank that fails alone leaves the others in messages that it never answers. It waits for them some
/// seconds, then throws, and `is_broken` of its ranks says that MPI must end them.
void call_together(MpiCommunicator&, const std::function<void()>& call);

}  // namespace strake
