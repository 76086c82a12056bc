#pragma once

#include <omp.h>

#include <cstdint>
#include <vector>

namespace strake::fluid {

/// Calls write(i, from, to) for each i < n, with from = size(0) + … + size(i − 1) and to = from + size(i).
/// Returns the sum of all. Each thread adds up its part of the numbers, and then writes it. Whole numbers
/// have no round-off, so the sums do not depend on the number of threads. size is called twice for most i,
/// and before write(i): write may overwrite what size reads.
template <class Size, class Write>
std::int64_t running_sum(std::int64_t n, Size&& size, Write&& write) {
  constexpr std::int64_t few = 4096;  // a second thread would cost more than it saves
  std::vector<std::int64_t> part;     // sum of each thread's part
  std::int64_t total = 0;
#pragma omp parallel if (n > few)
  {
    const std::int64_t team = omp_get_num_threads(), me = omp_get_thread_num();
    const std::int64_t first = n * me / team, last = n * (me + 1) / team;
#pragma omp single
    part.assign(static_cast<std::size_t>(team), 0);
    std::int64_t sum = 0;
    if (me + 1 < team)
      for (std::int64_t i = first; i < last; ++i) sum += size(i);
    part[static_cast<std::size_t>(me)] = sum;
#pragma omp barrier
    sum = 0;
    for (std::int64_t before = 0; before < me; ++before) sum += part[static_cast<std::size_t>(before)];
    for (std::int64_t i = first; i < last; ++i) {
      const std::int64_t to = sum + size(i);
      write(i, sum, to);
      sum = to;
    }
    if (me + 1 == team) total = sum;
  }
  return total;
}

}  // namespace strake::fluid
