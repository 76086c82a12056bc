#pragma once
// How a file appears whole or not at all, and how it outlasts a power cut.

#include <filesystem>
#include <string>
#include <string_view>

#include "proto/error.hpp"

namespace strake {

/// Writes `bytes` beside `path` (".part"), closes, renames. Throws Error(cannot_write).
void write_whole(const std::filesystem::path& path, std::string_view bytes);
/// The same, on the disk when it returns: the bytes before the name, so that a power cut leaves the old file
/// or the new one.
void write_lasting(const std::filesystem::path& path, std::string_view bytes);
/// Waits until the bytes of a file, or the names in a folder, are on the disk. Throws Error(cannot_write).
void sync_to_disk(const std::filesystem::path&);
/// The same for an open file; `path` for the error.
void sync_to_disk(int file, const std::filesystem::path& path);
/// Error(cannot_write) that names the file and what the system said.
Error cannot_write(const std::filesystem::path& path, int error_number);

}  // namespace strake
