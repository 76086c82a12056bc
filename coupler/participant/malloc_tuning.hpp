#pragma once

namespace strake {

/// Keeps freed memory in the process, up to 64 MB, so that the next window reuses it. Otherwise, in a process
/// that exchanges fields, the C library may return the memory of each field to the system and request it
/// again, page by page and cleared. This takes as much time as all the copies of a window. If
/// MALLOC_TRIM_THRESHOLD_ or GLIBC_TUNABLES is set, the user has decided.
void tune_malloc();

}  // namespace strake
