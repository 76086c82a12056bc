#pragma once

#include "coupler/compare/compare_block.hpp"
#include "proto/case/case_keys.hpp"
#include "proto/case/key_info.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// Questions to a case file that need no solver's program. Each reads the file anew and throws
/// Error(case_file).

/// The keys that more than one program reads. sets: --set strings.
CommonKeys common_keys_of(const std::filesystem::path& case_file, const std::vector<std::string>& sets = {});
/// The [[compare]] tables.
std::vector<CompareBlock> compare_blocks_of(const std::filesystem::path& case_file);
/// SHA-256 of the case, its --set strings and the files that it names.
std::array<std::uint8_t, 32> case_hash(const std::filesystem::path& case_file,
                                       const std::vector<std::string>& sets);
/// Those of `keys` ("coupling.surface.window") that the case or a --set string gives.
std::vector<std::string> given_among(const std::vector<std::string>& keys,
                                     const std::filesystem::path& case_file,
                                     const std::vector<std::string>& sets);
/// Declarations of all keys that the coupler reads.
std::vector<KeyInfo> coupler_declarations();

}  // namespace strake
