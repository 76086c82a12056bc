#include "structure/fem/mesh/refinement.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace strake::structure::fem {
namespace {

using Eigen::Index;

/// Cells from one graded end over `length`: as far as their size grows, and in all.
struct CellCount {
  double grown, cells_grown, cells;
};
CellCount count_from_one_end(double length, const Grading& grading) {
  const bool grows = grading.left || grading.right;
  const double grown = grows ? std::min(length, (grading.largest - grading.smallest) / grading.growth) : 0;
  const double cells_grown = std::log1p(grading.growth * grown / grading.smallest) / grading.growth;
  return {grown, cells_grown, cells_grown + (length - grown) / grading.largest};
}

double whole_number(double cells) {
  return std::max(1.0, std::ceil(cells - 1e-6));
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

/// Cell sizes along a part, by dimension. In the plane chosen on the clamped strips of cases/VALIDATION.md:
/// finer changes f1 by less than 0.05 %. In space a cell costs more.
struct Sizes {
  double smallest;      // [cell height] at a graded end
  double growth;        // per length
  double largest;       // [thickness] away from the ends
  double largest_part;  // [extent]
};
constexpr Sizes in_plane{0.5, 0.25, 0.5, 1 / 32.0}, in_space{1.0, 0.5, 4.0, 1 / 12.0};
// A part is thin along an axis where it measures less than so many times its smallest extent.
constexpr double thin = 2;

std::size_t interval_of(const std::vector<double>& plane, double x) {
  return static_cast<std::size_t>(std::upper_bound(plane.begin(), plane.end(), x) - plane.begin()) - 1;
}

Eigen::Vector3d middle_of_cell(const Solid& solid, Index c) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Index k = 0; k < solid.cell.rows(); ++k) sum += solid.node.col(solid.cell(k, c));
  return sum / static_cast<double>(solid.cell.rows());
}

/// Whether a support that holds stands in this plane: cells become small towards it.
bool supported_at(const Solid& solid, Index axis, double plane, double near) {
  for (const SupportedFace& face : solid.supported) {
    if (face.support == Support::symmetry || face.support == Support::free) continue;
    for (const int f : face.facet) {
      bool in_plane = true;
      for (Index k = 0; k < solid.facet.rows(); ++k)
        in_plane = in_plane && std::abs(solid.node(axis, solid.facet(k, f)) - plane) <= near;
      if (in_plane) return true;
    }
  }
  return false;
}

/// A turned body of boxes as it is before the turn.
Solid along_own_axes(const Solid& solid) {
  Solid level = solid;
  level.node = solid.turn.transpose() * solid.node;
  level.turn.setIdentity();
  return level;
}

/// How an interval between two planes is divided.
struct Division {
  double length = 0;  // [m]
  Grading grading = {};
};

/// Along one axis, for each interval between two planes.
std::vector<Division> divisions(const Solid& solid, Index axis, int refinement, double along_parts) {
  const Sizes& sizes = solid.dimension == 2 ? in_plane : in_space;
  const auto& plane = solid.plane[static_cast<std::size_t>(axis)];
  const Points extent = part_sizes(solid);
  std::vector<Division> all(plane.size() - 1);
  for (std::size_t i = 0; i + 1 < plane.size(); ++i) {
    Division& division = all[i];
    double least = std::numeric_limits<double>::infinity(), along = 0, height = 0;
    for (Index c = 0; c < solid.cell.cols(); ++c) {
      if (interval_of(plane, middle_of_cell(solid, c)[axis]) != i) continue;
      const int part = solid.part_of[static_cast<std::size_t>(c)];
      const double thickness = extent.col(part).head(solid.dimension).minCoeff();
      if (extent(axis, part) < thin * thickness)
        height = height == 0 ? std::ldexp(thickness, -refinement)
                             : std::min(height, std::ldexp(thickness, -refinement));
      least = std::min(least, thickness);
      along = std::max(along, extent(axis, part));
    }
    if (height == 0) height = along_parts;
    division.length = plane[i + 1] - plane[i];
    const double near = 1e-9 * division.length;
    Grading& grading = division.grading;
    if (height > 0) {  // evenly
      grading = {.smallest = height, .largest = height, .growth = 1};
      continue;
    }
    grading = {.smallest = sizes.smallest * std::ldexp(least, -refinement), .growth = sizes.growth};
    grading.largest = std::max(grading.smallest, std::min(sizes.largest * least, sizes.largest_part * along));
    grading.left = i > 0 || supported_at(solid, axis, plane[i], near);
    grading.right = i + 2 < plane.size() || supported_at(solid, axis, plane[i + 1], near);
  }
  return all;
}

}  // namespace

double graded_count(double length, const Grading& grading) {
  if (grading.left && grading.right) return 2 * whole_number(count_from_one_end(length / 2, grading).cells);
  return whole_number(count_from_one_end(length, grading).cells);
}

std::vector<double> graded_cells(double length, const Grading& grading) {
  assert(length > 0 && grading.smallest > 0 && grading.largest >= grading.smallest && grading.growth > 0);
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

double size_along(const FemKeys& fem, const Solid& solid) {
  // Clamped square plate: f1 0.2 % and f2 0.6 % above thin-plate theory; with 16 cells 1.0 and 2.6 %.
  constexpr double cells = 32;
  if (fem.cell_size > 0 || fem.strain != StrainField::solid_shell) return fem.cell_size;
  return part_sizes(solid).maxCoeff() / cells;
}

Solid refined(const Solid& solid, int refinement, double along) {
  if (!solid.made_of_boxes()) return solid;
  if (!solid.along_axes()) {
    Solid fine = refined(along_own_axes(solid), refinement, along);
    fine.node = solid.turn * fine.node;
    fine.turn = solid.turn;
    return fine;
  }
  const int dim = solid.dimension;

  // 1. Lines of the finer grid, and the interval of the coarse one that each of its cells lies in.
  std::array<std::vector<double>, 3> line;
  std::array<std::vector<std::size_t>, 3> interval;
  for (Index axis = 0; axis < dim; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto parts = divisions(solid, axis, refinement, along);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      double x = solid.plane[a][i];
      for (const double size : graded_cells(parts[i].length, parts[i].grading)) {
        line[a].push_back(x);
        interval[a].push_back(i);
        x += size;
      }
    }
    line[a].push_back(solid.plane[a].back());
  }
  if (dim == 2) interval[2] = {0};

  // 2. Who owns the coarse intervals.
  std::map<std::array<std::size_t, 3>, int> owner;
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    const Eigen::Vector3d X = middle_of_cell(solid, c);
    std::array<std::size_t, 3> at{};
    for (Index axis = 0; axis < dim; ++axis)
      at[static_cast<std::size_t>(axis)] = interval_of(solid.plane[static_cast<std::size_t>(axis)], X[axis]);
    owner[at] = solid.part_of[static_cast<std::size_t>(c)];
  }

  // 3. The finer cells.
  Solid fine;
  fine.dimension = dim;
  fine.parts = solid.parts;
  fine.plane = line;
  fill_grid(fine, [&](const std::array<std::size_t, 3>& at) {
    const auto found = owner.find({interval[0][at[0]], interval[1][at[1]], interval[2][at[2]]});
    return found == owner.end() ? -1 : found->second;
  });
  return fine;
}

double refined_count(const Solid& solid, int refinement, double along) {
  if (!solid.made_of_boxes()) return static_cast<double>(solid.cell.cols());
  if (!solid.along_axes()) return refined_count(along_own_axes(solid), refinement, along);
  std::array<std::vector<Division>, 3> parts;
  for (Index axis = 0; axis < solid.dimension; ++axis)
    parts[static_cast<std::size_t>(axis)] = divisions(solid, axis, refinement, along);
  double count = 0;
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    const Eigen::Vector3d X = middle_of_cell(solid, c);
    double cells = 1;
    for (Index axis = 0; axis < solid.dimension; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const Division& part = parts[a][interval_of(solid.plane[a], X[axis])];
      cells *= graded_count(part.length, part.grading);
    }
    count += cells;
  }
  return count;
}

}  // namespace strake::structure::fem
