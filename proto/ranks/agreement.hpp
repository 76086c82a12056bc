#pragma once

#include "proto/files/file_part.hpp"
#include "proto/ranks/communicator.hpp"

#include <functional>
#include <vector>

namespace strake {

/// Calls a function on all ranks, and then lets them agree: where it has thrown on one of them, all ranks
/// throw the Error of the first such rank. So none of them waits for one that has given up. The function must
/// not call another rank.
void on_all_ranks(Communicator&, const std::function<void()>&);

/// The same on the first rank alone; the others wait for it.
void on_first_rank(Communicator&, const std::function<void()>&);

/// Returns the part of a file that each rank has written, in the order of ranks.
std::vector<FilePart> parts_of_all(Communicator&, const FilePart& own);

}  // namespace strake
