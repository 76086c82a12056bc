#pragma once

#include "structure/body/parameters.hpp"
#include "structure/body/solid.hpp"

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

/// Size of the cells along the parts [m], 0: graded. structure.fem.cell_size; of solid shells, where that is
/// not given, 1/32 of the longest part.
double size_along(const FemKeys&, const Solid&);

/// Divides a solid made of boxes into a conforming mesh of finite elements. Each part has 2^refinement cells
/// through its thickness. Along its length and width the cells have the size `along`. With along = 0 they
/// grow away from supports and from planes where parts meet, since the stress is singular in corners. A solid
/// from a mesh file keeps the cells of the file.
Solid refined(const Solid&, int refinement, double along = 0);
/// How many cells that has, without making them.
double refined_count(const Solid&, int refinement, double along = 0);

}  // namespace strake::structure::fem
