#pragma once

#include <filesystem>
#include <string>

namespace strake {

/// The name of the file that `seal` writes.
inline constexpr const char* seal_name = "checksums";

/// Writes `checksums` into a folder: size and BLAKE2b of every file in it, whoever wrote it. Written last,
/// when all of them are on the disk, so that a folder that holds it is whole. Throws Error(cannot_write).
void seal(const std::filesystem::path& folder);

/// What is wrong with a folder that was sealed ("fluid.h5 holds 100 bytes, not 20480"); empty when every file
/// is as it was.
std::string damage(const std::filesystem::path& folder);

}  // namespace strake
