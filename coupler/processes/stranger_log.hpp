#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace strake {

/// Counts what strangers did at the port, for console and log. Each kind is reported when it first happens,
/// then its number at growing intervals. A flood makes lines, and does not fill a disk.
class StrangerLog {
 public:
  using Clock = std::chrono::steady_clock;

  /// Lines that are due now.
  std::vector<std::string> note(const std::string& what, int times, Clock::time_point now);
  std::vector<std::string> due(Clock::time_point now);

 private:
  struct Kind {
    int untold = 0;
    Clock::time_point told;
    Clock::duration quiet;  // until the next line
  };
  std::map<std::string, Kind> kinds_;
};

/// Text of a stranger for a log: one line, without control characters (`visible`), of its first 200 bytes.
std::string harmless(const std::string&);

}  // namespace strake
