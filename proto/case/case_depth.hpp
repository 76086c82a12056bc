#pragma once
// How deep a TOML text may nest.

#include <cstddef>
#include <string>

namespace strake {

/// Keys and values within one another, at most. A case needs five.
inline constexpr std::size_t deepest_key = 64;

/// Throws Error(case_file) with the line where a text goes deeper than `deepest_key`. The parser, and all
/// that walks through what it read, call themselves once for each level: a text must not choose how often.
void require_shallow(const std::string& toml, const std::string& name);

}  // namespace strake
