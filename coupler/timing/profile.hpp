#pragma once

#include "coupler/coupling/window_loop.hpp"
#include "coupler/coupling/window_report.hpp"
#include "coupler/processes/exchange_times.hpp"
#include "proto/files/json_file.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Divides the time of a run's windows into shares, from the clocks of its processes: `strake run --profile`.
///
/// At each moment the wall time of the windows and their files belongs to one of these shares; they add up to
/// one:
/// - a participant computes;
/// - two compute at once (parallel coupling);
/// - a message is under way, or a process wakes up;
/// - the coupler works;
/// - files are written.
class Profile {
 public:
  struct Seconds {
    std::map<std::string, double> computing;  // participant → while it computes, another too or not
    double together = 0;                      // while more than one computes
    double messages = 0, coupler = 0, files = 0;
    double total() const;  // wall time of windows and files
  };

  void add(const Exchange&);
  /// The window that is committed, from its first question to its commit, and then its files.
  void end_window(const WindowReport&, std::int64_t begin, std::int64_t end, std::int64_t files_end);

  const Seconds& seconds() const { return seconds_; }
  std::vector<std::string> lines() const;
  Json json() const;

 private:
  struct Span {
    std::int64_t begin = 0, end = 0;  // [ns]
  };
  /// Nanoseconds within any of the spans, and within more than one; sorts them.
  static std::pair<std::int64_t, std::int64_t> covered(std::vector<Span>&);

  std::map<std::string, ClockOffset> clocks_;
  std::vector<Span> computing_, awaiting_;  // of the window under way
  Seconds seconds_;
  long windows_ = 0, iterations_ = 0;
  std::map<std::string, std::map<std::string, double>> stages_;  // participant → stage → [s] so far
  std::map<std::string, std::vector<RankShare>> ranks_;          // of a participant on several
};

}  // namespace strake
