#pragma once

#include <cstdio>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// Recent speed of a run: over its last quarter, and at least 5 s. Windows after contact take longer than
/// those before.
class RecentSpeed {
 public:
  /// elapsed: wall clock [s]; time: simulated [s]; steps: of a solver, since its start.
  void add(double elapsed, double time, double steps);
  /// [s] of wall clock up to the simulated time `end`; none while too little is known.
  std::optional<double> remaining(double end) const;
  std::optional<double> steps_per_second() const;

 private:
  struct Sample {
    double elapsed = 0, time = 0, steps = 0;
  };
  std::deque<Sample> samples_;  // ascending
  double begin_ = 0;            // [s] elapsed at the first one
};

/// What the bar shows.
struct Progress {
  double time = 0, end_time = 0;  // [s] simulated
  std::optional<double> remaining, steps_per_second;
  int iterations = 0;               // of the last window; 0: not coupled
  std::vector<std::string> probes;  // "mid.y 1.742 mm"
  std::string waiting;              // for whom, and what that one does; stands in the probes' place
};

/// Lines of the progress bar, none wider than `width` - 1 characters. What has no room is left out, the least
/// important first. unicode: blocks instead of number signs.
std::vector<std::string> progress_rows(const Progress&, int width, bool unicode);

/// Characters that a UTF-8 text takes on a terminal.
int display_width(const std::string& text);
/// As much of it as fits `width` characters.
std::string cut_to_width(const std::string& text, int width);

/// Rows that stand below all other lines of a terminal and are drawn anew in place.
class LiveRows {
 public:
  explicit LiveRows(std::FILE* stream) : stream_(stream) {}
  ~LiveRows() { show("", {}, 0); }
  LiveRows(const LiveRows&) = delete;
  LiveRows& operator=(const LiveRows&) = delete;
  /// Removes the lines of the bar, prints `above` (whole lines) in their place, and draws `rows`, in one
  /// write. width: of the terminal now. Earlier lines that a narrower terminal has broken are removed
  /// completely.
  void show(const std::string& above, const std::vector<std::string>& rows, int width);
  bool empty() const { return drawn_.empty(); }

 private:
  std::FILE* stream_;
  std::vector<int> drawn_;  // widths of the bar's lines on the screen
};

}  // namespace strake
