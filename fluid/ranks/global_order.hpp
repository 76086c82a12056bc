#pragma once

#include "proto/ranks/communicator.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Sorts numbers of all ranks by key, equal keys by their old place. Returns the place of each own one in the
/// whole. Each rank sorts a range of keys.
std::vector<std::int64_t> places_by_key(Communicator&, std::span<const std::uint64_t> key,
                                        std::span<const std::int64_t> old_place);

}  // namespace strake::fluid
