#pragma once

namespace strake {

/// For a process that exchanges fields: what it frees stays with it, up to 64 MB, and the next window has it
/// again. Otherwise the C library may give the memory of each field back to the system, and be given it anew,
/// page by page and cleared, at as much time as all the copies of a window take. Where MALLOC_TRIM_THRESHOLD_
/// or GLIBC_TUNABLES is set, the user has decided.
void keep_freed_memory();

}  // namespace strake
