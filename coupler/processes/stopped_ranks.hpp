#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <sys/types.h>

namespace strake {

/// Finds a rank that is stopped by a signal before the first Hello. All others wait for it in the start of
/// MPI. Later the ranks watch one another (proto/ranks/rank_watch.hpp).
class StoppedRanks {
 public:
  using Clock = std::chrono::steady_clock;

  /// Looks at a launcher and at the processes that it has started on this machine, four times a second at
  /// most. Returns one of them that was stopped in all looks of three seconds. A clock would also count the
  /// time in which this process was stopped itself.
  std::optional<pid_t> look(pid_t launcher, Clock::time_point now);

 private:
  Clock::time_point next_;
  std::map<pid_t, int> stopped_;  // looks in a row that have found it stopped
};

}  // namespace strake
