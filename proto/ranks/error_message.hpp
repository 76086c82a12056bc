#pragma once

#include "proto/error.hpp"
#include "proto/ranks/communicator.hpp"

#include <functional>
#include <optional>

namespace strake {

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
