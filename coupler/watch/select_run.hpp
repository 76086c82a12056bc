#pragma once

#include "coupler/watch/run_status.hpp"

#include <string>
#include <vector>

namespace strake::watch {

/// Chooses the columns of history.csv that are shown first, at most `most`. Of each probe it takes the value
/// itself, or its y component; then the force along y of a coupled run; then the others.
std::vector<std::size_t> chosen_columns(const WatchedRun&, std::size_t most);

/// Whose logarithm is drawn: residuals.
bool is_logarithmic(const std::string& column);

/// Time of one stage of the work [s], largest first: "fluid.pressure", "structure.solve", and coupler and
/// exchange beside them. Sums over the windows in timing.csv.
struct Stage {
  std::string name;
  double seconds = 0;
};
std::vector<Stage> stages(const WatchedRun&);

/// The least and largest value of a column and when they were.
struct Extremes {
  double lo = 0, time_lo = 0, hi = 0, time_hi = 0;
  bool any = false;
};
Extremes extremes(const TableTail&, std::size_t column);

}  // namespace strake::watch
