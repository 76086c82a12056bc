#pragma once

#include "proto/error.hpp"
#include "proto/files/file_part.hpp"
#include "proto/ranks/communicator.hpp"

#include <functional>
#include <optional>
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

/// Returns what a call throws, as an Error; nothing: it ends well. What is no Error has an empty place.
std::optional<Error> error_of(const std::function<void()>& call);

/// The same error with the number of the rank in front of its place.
Error of_rank(int rank, const Error&);

/// An error as bytes for another rank, and back. Nothing is no bytes.
Bytes packed(const std::optional<Error>&);
Error unpacked(const Bytes&);

/// A text behind its length in a message, and back.
void append_text(Bytes&, const std::string&);
std::string take_text(const std::byte*& at);

}  // namespace strake
