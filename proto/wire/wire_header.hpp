#pragma once

#include "proto/wire/wire_arrays.hpp"

#include <fmt/format.h>
#include <google/protobuf/arena.h>
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <climits>
#include <cstddef>
#include <span>

namespace strake::wire {

/// Memory for the protobuf header of a call: one block, which is released at once when the call ends.
class Scratch {
 public:
  template <class Header>
  Header& header() {
    return *google::protobuf::Arena::CreateMessage<Header>(&arena_);
  }

 private:
  alignas(std::max_align_t) std::array<char, 4096> block_;
  google::protobuf::Arena arena_{block_.data(), block_.size()};
};

/// Reads the header of a message, its first part. rules: whose message it is, for the error.
template <class Header>
const Header& parse_header(Scratch& scratch, const Parts& parts, const Rules& rules) {
  if (parts.empty()) rules.broken("has no parts");
  const std::span<const std::byte> bytes = parts.front().bytes;
  Header& header = scratch.header<Header>();
  const google::protobuf::LogSilencer no_lines_of_its_own;  // what is wrong is said below, once
  if (bytes.size() > INT_MAX || !header.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    rules.broken(fmt::format("has a header of {} bytes that cannot be read", bytes.size()));
  return header;
}

}  // namespace strake::wire
