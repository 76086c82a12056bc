#include "structure/fem/mesh/grading.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake::structure::fem {
namespace {

/// Cells from one graded end over `length`: as far as their size grows, and in all.
struct CellCount {
  double grown, cells_grown, cells;
};
CellCount count_from_one_end(double length, const Grading& grading) {
  const double grown = std::min(length, (grading.largest - grading.smallest) / grading.growth);
  const double cells_grown = std::log1p(grading.growth * grown / grading.smallest) / grading.growth;
  return {grown, cells_grown, cells_grown + (length - grown) / grading.largest};
}

double whole_number(double cells) {
  return std::max(1.0, std::ceil(cells - 1e-9));
}

/// Sizes from one graded end over `length`. The number of cells up to x is N(x) = ∫ dx / s(x): a logarithm
/// where the size grows, then a straight line. Vertices are where N, scaled to end on a whole number, takes
/// whole values.
std::vector<double> from_one_end(double length, const Grading& grading) {
  const auto [grown, cells_grown, cells] = count_from_one_end(length, grading);
  const int n = static_cast<int>(whole_number(cells));
  std::vector<double> sizes;
  double last = 0;
  for (int i = 1; i <= n; ++i) {
    const double count = cells * i / n;
    double x = length;
    if (i < n)
      x = count < cells_grown ? grading.smallest * std::expm1(grading.growth * count) / grading.growth
                              : grown + (count - cells_grown) * grading.largest;
    sizes.push_back(x - last);
    last = x;
  }
  return sizes;
}

}  // namespace

double graded_count(double length, const Grading& grading) {
  if (!grading.left && !grading.right) return whole_number(length / grading.largest);
  if (grading.left && grading.right) return 2 * whole_number(count_from_one_end(length / 2, grading).cells);
  return whole_number(count_from_one_end(length, grading).cells);
}

std::vector<double> graded_cells(double length, const Grading& grading) {
  assert(length > 0 && grading.smallest > 0 && grading.largest >= grading.smallest && grading.growth > 0);
  if (!grading.left && !grading.right) {
    const auto n = static_cast<std::size_t>(whole_number(length / grading.largest));
    return std::vector<double>(n, length / static_cast<double>(n));
  }
  if (grading.left && grading.right) {
    std::vector<double> sizes = from_one_end(length / 2, grading);
    std::vector<double> mirrored(sizes.rbegin(), sizes.rend());
    sizes.insert(sizes.end(), mirrored.begin(), mirrored.end());
    return sizes;
  }
  std::vector<double> sizes = from_one_end(length, grading);
  if (grading.right) std::reverse(sizes.begin(), sizes.end());
  return sizes;
}

}  // namespace strake::structure::fem
