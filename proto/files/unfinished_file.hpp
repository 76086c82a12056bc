#pragma once

namespace strake {

/// Removes the file that `write_whole` is writing at this moment, if any. It serves signal handlers that end
/// the process: it uses plain system calls alone.
void remove_unfinished_file() noexcept;

}  // namespace strake
