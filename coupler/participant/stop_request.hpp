#pragma once

#include "proto/error.hpp"

#include <chrono>
#include <string>

namespace strake {

/// Ctrl-C, SIGTERM, or SIGHUP (the terminal is gone, unless nohup has it ignored), as a flag that loops and
/// waits look at. A second signal but SIGHUP (0.2 s later or more) ends the process at once (exit 130 or 143;
/// the participants notice that the coupler is gone). Make one in main, before any other thread.
///
/// Nobody waits in vain: where the flag has not been looked at for a second, the process ends by itself, or,
/// after end_in_order, a line on the standard error says that the signal was heard.
class StopRequest {
 public:
  StopRequest();   // installs the handlers
  ~StopRequest();  // puts the former ones back
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  bool requested() const;
  ExitCode code() const;         // interrupted, terminated or hung_up; done while not requested
  std::string in_words() const;  // "interrupted by Ctrl-C", "ended by SIGTERM"
  std::chrono::steady_clock::duration elapsed() const;  // since the first signal; zero while not requested
  /// From here on there is something to save: the process is ended by nobody but its own loops.
  void end_in_order() const;
};

}  // namespace strake
