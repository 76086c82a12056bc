#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Wall-clock time of sections that a solver names. They may lie in one another.
class Sections {
 public:
  void start(std::string name);
  /// Ends the one that was started last. Error(solver_fault) if none is open.
  void stop();
  /// Seconds so far under the names "seconds.<section>", of sections that have ended.
  std::map<std::string, double> seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<std::pair<std::string, Clock::time_point>> open_;
  std::map<std::string, double> seconds_;
};

}  // namespace strake
