#pragma once

#include "coupler/processes/remote.hpp"

#include <filesystem>
#include <memory>

namespace spdlog {
class logger;
}

namespace strake {

/// coupler.log of a run. Throws Error(cannot_write).
std::shared_ptr<spdlog::logger> open_run_log(const std::filesystem::path&);

/// Where the console has gone (a pipe that was closed, a full disk) a run goes on. Its log says so once, and,
/// but for a pipe, so does a line on the standard error.
class ConsoleLoss {
 public:
  void look(spdlog::logger&, const std::filesystem::path& log);

 private:
  bool told_ = false;
};

/// What a participant does that answers late, as lines for the log: the first after 10 s, then one every
/// 10 s, so that whoever reads the log knows how far it is.
class WaitLog {
 public:
  /// The line for now; empty while none is due.
  std::string line(const Awaited&);

 private:
  double told_ = 0;  // [s] of waiting, at the last line
};

}  // namespace strake
