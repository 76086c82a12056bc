#pragma once

#include "proto/error.hpp"

#include <filesystem>
#include <string>

namespace strake {

class StopRequest;

struct WatchOptions {
  std::filesystem::path run;  // empty: the newest under `runs`
  std::filesystem::path runs = "runs";
  bool web = false;  // a page instead of the terminal's view
  int port = 0;      // of the page; 0: a free one
  std::string bind = "127.0.0.1";
};
/// Shows a running or finished run until it ends, or the reader has enough. Returns the run's own exit code
/// once it has ended; participant_lost for a run that was killed; done where the reader left first.
ExitCode watch_run(const WatchOptions&, const StopRequest&);

}  // namespace strake
