#pragma once
// Private to proto/: how a file appears whole or not at all.

#include <filesystem>
#include <string>
#include <string_view>

#include "proto/error.hpp"

namespace strake {

/// Writes `bytes` beside `path` (".part"), closes, renames. Throws Error(cannot_write).
void write_whole(const std::filesystem::path& path, std::string_view bytes);
/// Error(cannot_write) that names the file and what the system said.
Error cannot_write(const std::filesystem::path& path, int error_number);

}  // namespace strake
