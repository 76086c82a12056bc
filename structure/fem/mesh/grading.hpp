#pragma once

#include <vector>

namespace strake::structure::fem {

/// Cell sizes along a line: s(x) = min(largest, smallest + growth · distance to the nearest graded end).
struct Grading {
  double smallest = 0, largest = 0;  // [m]
  double growth = 0;                 // size gained per length walked away from a graded end, 1
  bool left = false, right = false;  // ends to which the cells become small
};

/// Sizes [m] of the cells that divide `length`, from left to right. They are the wanted sizes, scaled so that
/// a whole number of cells fits. Even in number and symmetric when both ends are graded, so that the middle
/// is a vertex.
std::vector<double> graded_cells(double length, const Grading&);
/// How many those are, without making them: no integer, since there may be too many for one.
double graded_count(double length, const Grading&);

}  // namespace strake::structure::fem
