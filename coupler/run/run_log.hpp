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

/// A run continues when its console is gone (a closed pipe, a full disk). Its log says so once. Except for a
/// pipe, so does a line on the standard error.
class ConsoleLoss {
 public:
  void look(spdlog::logger&, const std::filesystem::path& log);

 private:
  bool told_ = false;
};

/// Reports what a slow participant does, as lines for the log. The first comes after 10 s, then one every 10
/// s, so that a reader of the log knows the progress.
class WaitLog {
 public:
  /// The line for now; empty while none is due.
  std::string line(const Awaited&);

 private:
  double told_ = 0;  // [s] of waiting, at the last line
};

}  // namespace strake
