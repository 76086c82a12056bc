#include "structure/fem/mesh/refinement.hpp"

#include "structure/fem/mesh/grading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace strake::structure::fem {
namespace {

using Eigen::Index;

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

/// How an interval between two planes is divided: evenly into cells of a height, or graded.
struct Division {
  double length = 0, height = 0;  // [m] height 0: graded
  Grading grading = {};

  double count() const {
    return height > 0 ? std::max(1.0, std::ceil(length / height - 1e-6)) : graded_count(length, grading);
  }
  std::vector<double> sizes() const {
    if (height == 0) return graded_cells(length, grading);
    return std::vector<double>(static_cast<std::size_t>(count()), length / count());
  }
};

/// Along one axis, for each interval between two planes.
std::vector<Division> divisions(const Solid& solid, Index axis, int refinement) {
  const Sizes& sizes = solid.dimension == 2 ? in_plane : in_space;
  const auto& plane = solid.plane[static_cast<std::size_t>(axis)];
  const Points extent = part_sizes(solid);
  std::vector<Division> all(plane.size() - 1);
  for (std::size_t i = 0; i + 1 < plane.size(); ++i) {
    Division& division = all[i];
    double least = std::numeric_limits<double>::infinity(), along = 0;
    for (Index c = 0; c < solid.cell.cols(); ++c) {
      if (interval_of(plane, middle_of_cell(solid, c)[axis]) != i) continue;
      const int part = solid.part_of[static_cast<std::size_t>(c)];
      const double thickness = extent.col(part).head(solid.dimension).minCoeff();
      double& height = division.height;  // of a cell through a part that is thin here
      if (extent(axis, part) < thin * thickness)
        height = height == 0 ? std::ldexp(thickness, -refinement)
                             : std::min(height, std::ldexp(thickness, -refinement));
      least = std::min(least, thickness);
      along = std::max(along, extent(axis, part));
    }
    division.length = plane[i + 1] - plane[i];
    const double near = 1e-9 * division.length;
    Grading& grading = division.grading;
    grading = {.smallest = sizes.smallest * std::ldexp(least, -refinement), .growth = sizes.growth};
    grading.largest = std::max(grading.smallest, std::min(sizes.largest * least, sizes.largest_part * along));
    grading.left = i > 0 || supported_at(solid, axis, plane[i], near);
    grading.right = i + 2 < plane.size() || supported_at(solid, axis, plane[i + 1], near);
  }
  return all;
}

}  // namespace

Solid refined(const Solid& solid, int refinement) {
  if (!solid.made_of_boxes()) return solid;
  const int dim = solid.dimension;

  // 1. Lines of the finer grid, and the interval of the coarse one that each of its cells lies in.
  std::array<std::vector<double>, 3> line;
  std::array<std::vector<std::size_t>, 3> interval;
  for (Index axis = 0; axis < dim; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const auto parts = divisions(solid, axis, refinement);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      double x = solid.plane[a][i];
      for (const double size : parts[i].sizes()) {
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

  // 3. The finer cells, x fastest.
  Solid fine;
  fine.dimension = dim;
  fine.parts = solid.parts;
  fine.plane = line;
  const std::size_t nx = line[0].size(), ny = line[1].size(), nz = std::max<std::size_t>(1, line[2].size());
  std::vector<int> number(nx * ny * nz, -1), cells;
  std::vector<Eigen::Vector3d> node;
  const int corners = 1 << dim;
  for (std::size_t k = 0; k < interval[2].size(); ++k)
    for (std::size_t j = 0; j < interval[1].size(); ++j)
      for (std::size_t i = 0; i < interval[0].size(); ++i) {
        const auto found = owner.find({interval[0][i], interval[1][j], interval[2][k]});
        if (found == owner.end()) continue;
        fine.part_of.push_back(found->second);
        for (int corner = 0; corner < corners; ++corner) {
          const std::size_t x = i + static_cast<std::size_t>(corner & 1),
                            y = j + static_cast<std::size_t>((corner >> 1) & 1),
                            z = k + static_cast<std::size_t>((corner >> 2) & 1);
          int& at = number[(z * ny + y) * nx + x];
          if (at < 0) {
            at = static_cast<int>(node.size());
            node.emplace_back(line[0][x], line[1][y], dim == 3 ? line[2][z] : 0.0);
          }
          cells.push_back(at);
        }
      }
  fine.cell = Eigen::Map<Eigen::MatrixXi>(cells.data(), corners, static_cast<Index>(fine.part_of.size()));
  fine.node.resize(3, static_cast<Index>(node.size()));
  for (std::size_t i = 0; i < node.size(); ++i) fine.node.col(static_cast<Index>(i)) = node[i];
  return fine;
}

double refined_count(const Solid& solid, int refinement) {
  if (!solid.made_of_boxes()) return static_cast<double>(solid.cell.cols());
  std::array<std::vector<Division>, 3> parts;
  for (Index axis = 0; axis < solid.dimension; ++axis)
    parts[static_cast<std::size_t>(axis)] = divisions(solid, axis, refinement);
  double count = 0;
  for (Index c = 0; c < solid.cell.cols(); ++c) {
    const Eigen::Vector3d X = middle_of_cell(solid, c);
    double cells = 1;
    for (Index axis = 0; axis < solid.dimension; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      cells *= parts[a][interval_of(solid.plane[a], X[axis])].count();
    }
    count += cells;
  }
  return count;
}

}  // namespace strake::structure::fem
