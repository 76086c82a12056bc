#pragma once

#include "proto/error.hpp"

#include <chrono>
#include <string>

namespace strake {

/// A flag that Ctrl-C, SIGTERM or SIGHUP sets, which loops and waits test. (SIGHUP: the terminal is closed,
/// unless nohup ignores it.) A second signal except SIGHUP (0.2 s later or more) ends the process at once,
/// with exit 130 or 143; the participants detect that the coupler is gone. Make one in main, before any other
/// thread.
///
/// If the flag is not tested for a second, the process ends by itself. After end_in_order, a line on the
/// standard error says instead that the signal was received.
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
  /// From this call on there is data to save: only the process's own loops end it.
  void end_in_order() const;
};

}  // namespace strake
