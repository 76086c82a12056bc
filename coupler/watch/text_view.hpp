#pragma once

#include "coupler/watch/run_status.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace strake::watch {

/// What a terminal can show.
struct Screen {
  int width = 80, height = 24;  // [characters]
  bool colour = false;
};
/// A run as lines that fill at most the given screen. They show state, progress, curves with their latest
/// value and extremes, processes, and where the time goes. Without colour the lines contain no control
/// characters.
std::vector<std::string> screen_lines(const WatchedRun&, const Screen&);

/// A run as plain lines, for a pipe. There is a head, then one line per call of `more` with new windows, then
/// the end.
class PlainLines {
 public:
  explicit PlainLines(std::FILE* stream) : stream_(stream) {}
  void begin(const WatchedRun&);
  /// Prints the last window and whether the state is another one.
  void more(const WatchedRun&);
  void end(const WatchedRun&);

 private:
  void say_state(const WatchedRun&);
  void put(const std::string& line);
  std::FILE* stream_;
  std::vector<std::size_t> columns_;  // of the table, once there is a history
  std::vector<std::size_t> widths_;
  std::uint32_t generation_ = 0;
  long window_ = -1;
  std::string said_;
};

/// A value in a prefixed unit: "1.742 mm"; "–" for none.
std::string value_text(double value, const std::string& unit);

/// A curve in characters: lines of `columns` braille characters, each of 2×4 dots, from the highest values
/// down.
struct BraillePlot {
  std::vector<std::string> lines;  // UTF-8, every one `columns` characters wide
  double lo = 0, hi = 0;           // values at the lower and upper edge
};
/// x ascends; points that are not finite are left out and break the curve. Where several
/// points fall into one column of dots, all that lies between the least and the largest is drawn, so that no
/// peak is lost. Empty lines where no point is finite.
BraillePlot braille_plot(const std::vector<double>& x, const std::vector<double>& y, int columns, int rows,
                         bool logarithmic = false);

/// How many characters a terminal shows of an UTF-8 text (all of ours are one column wide).
std::size_t shown_width(const std::string&);
/// A text as wide as that: cut, with "…", or with blanks behind it; control characters are made visible.
std::string fitted(const std::string&, std::size_t width);

}  // namespace strake::watch
