#include "coupler/participant/launch.hpp"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace strake {

void tune_malloc() {
#ifdef __GLIBC__
  if (std::getenv("MALLOC_TRIM_THRESHOLD_") || std::getenv("GLIBC_TUNABLES")) return;
  // What glibc comes to by itself once a block of the larger size has been freed.
  constexpr int largest_kept = 32 << 20, kept = 64 << 20;  // [bytes]
  mallopt(M_MMAP_THRESHOLD, largest_kept);
  mallopt(M_TRIM_THRESHOLD, kept);
#endif
}

}  // namespace strake
