#pragma once

#include "proto/case/case_keys.hpp"

#include <algorithm>
#include <thread>

namespace strake {

/// Number of processors that this process may use.
inline int processors_here() {
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// Threads of each of the ranks on one machine: run.threads, or where the case does not give it
///   max(1, processors / ranks).
/// Results do not depend on it.
inline int threads_of_rank(const CommonKeys& common, int ranks, int processors) {
  return common.threads_given ? common.threads : std::max(1, processors / std::max(1, ranks));
}

}  // namespace strake
