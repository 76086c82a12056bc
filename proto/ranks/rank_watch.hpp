#pragma once

#include "proto/ranks/communicator.hpp"

#include <string>
#include <sys/types.h>
#include <thread>

namespace strake {

/// Watches the next rank on the same machine. A rank that is stopped would let all others wait for ever.
/// After three seconds it is killed: the launcher names it, and ends the others. A rank that has died is the
/// launcher's business.
class RankWatch {
 public:
  /// All ranks construct it together.
  /// `part`: what they compute, for the message, as in "fluid".
  RankWatch(Communicator&, const std::string& part);

 private:
  std::jthread thread_;
};

/// Whether a process is stopped by a signal. False for one that is not there.
bool is_stopped(pid_t);

}  // namespace strake
