#pragma once

#include <string>
#include <vector>

namespace strake::watch {

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
