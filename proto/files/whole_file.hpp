#pragma once

// Writes files that appear whole or not at all and survive a power cut. Reads files of limited size.

#include "proto/error.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace strake {

/// Largest files that are read [bytes]. A larger file of a user cannot be what its key expects.
inline constexpr std::uintmax_t largest_case = std::uintmax_t{16} << 20,
                                largest_table = std::uintmax_t{1} << 30,
                                largest_mesh = std::uintmax_t{1} << 29,
                                any_size = ~std::uintmax_t{0};  // of a file that a run has written

/// Refuses a path that is no regular file, or a file above `largest` bytes. A pipe, a device or a socket may
/// never end. `where` stands for the path in messages. Throws Error(case_file).
void require_file(const std::filesystem::path&, std::uintmax_t largest, const std::string& where);
/// Bytes of a file that passes `require_file`, as many as it had when it was opened. Throws Error(case_file).
std::string read_whole(const std::filesystem::path&, std::uintmax_t largest, const std::string& where);

/// Writes `bytes` beside `path` (".part"), closes, renames. Throws Error(cannot_write).
void write_whole(const std::filesystem::path& path, std::string_view bytes);
/// Does the same, and returns once the file is on the disk. The bytes are on the disk before the name, so
/// that a power cut leaves the old file or the new one.
void write_lasting(const std::filesystem::path& path, std::string_view bytes);
/// Waits until the bytes of a file, or the names in a folder, are on the disk. Throws Error(cannot_write).
void sync_to_disk(const std::filesystem::path&);
/// The same for an open file; `path` for the error.
void sync_to_disk(int file, const std::filesystem::path& path);
/// Error(cannot_write) that names the file and what the system said.
Error cannot_write(const std::filesystem::path& path, int error_number);

/// Removes the file that `write_whole` is writing at this moment, if any. It serves signal handlers that end
/// the process: it uses plain system calls alone.
void remove_unfinished_file() noexcept;

}  // namespace strake
