#pragma once

#include "proto/error.hpp"

#include <chrono>
#include <string>

namespace strake {

/// Ctrl-C or SIGTERM, as a flag that loops and waits look at. A second signal (0.2 s later or more) ends the
/// process at once (exit 130 or 143; the participants notice that the coupler is gone). Make one in main,
/// before any other thread.
class StopRequest {
 public:
  StopRequest();   // installs handlers for SIGINT and SIGTERM
  ~StopRequest();  // puts the former ones back
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;

  bool requested() const;
  ExitCode code() const;                                // interrupted or terminated; done while not requested
  std::string in_words() const;                         // "interrupted by Ctrl-C", "ended by SIGTERM"
  std::chrono::steady_clock::duration elapsed() const;  // since the first signal; zero while not requested
};

}  // namespace strake
