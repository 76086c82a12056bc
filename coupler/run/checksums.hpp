#pragma once

#include <filesystem>
#include <string>

namespace strake {

/// The name of the file that `write_checksums` writes.
inline constexpr const char* checksums_name = "checksums";

/// Writes `checksums` into a folder: size and BLAKE2b of every file in it. It is written last, when all files
/// are on the disk, so that a folder with it is complete. Throws Error(cannot_write).
void write_checksums(const std::filesystem::path& folder);

/// Describes the damage to a folder with checksums ("fluid.h5 holds 100 bytes, not 20480"). Empty if every
/// file is unchanged.
std::string damage(const std::filesystem::path& folder);

}  // namespace strake
