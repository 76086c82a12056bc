#include "fluid/size.hpp"

#include "fluid/boundary/fill.hpp"

#include <cmath>

namespace strake::fluid {
namespace {

using Shape = std::vector<Eigen::Vector3d>;

/// Lengths [l0] of the tank along each axis; 1 along z in two dimensions.
Eigen::Vector3d tank_lengths(const Parameters& p) {
  Eigen::Vector3d lengths = (p.tank.max - p.tank.min) / p.spacing;
  if (p.dimension == 2) lengths.z() = 1;
  return lengths;
}

double polygon_area(const Shape& corners) {
  double area = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector3d &a = corners[k], &b = corners[(k + 1) % corners.size()];
    area += 0.5 * (a.x() * b.y() - b.x() * a.y());
  }
  return std::abs(area);
}

double water_count(const Parameters& p) {
  double count = 0;
  for (const Shape& shape : water_shapes(p))
    count += shape.size() == 2 ? ((shape[1] - shape[0]).head(p.dimension) / p.spacing).array().prod()
                               : polygon_area(shape) / (p.spacing * p.spacing);
  return count;
}

/// Counts the particles of `rows` layers behind the walls.
double wall_count(const Parameters& p, double rows) {
  double count = 0;
  if (!p.tank_polygon.empty()) {
    const std::size_t n = p.tank_polygon.size();
    for (std::size_t k = 0; k < (p.open_top ? n - 1 : n); ++k)
      count += (p.tank_polygon[(k + 1) % n] - p.tank_polygon[k]).norm() / p.spacing;
    return rows * count;
  }
  const Eigen::Vector3d inner = tank_lengths(p);
  Eigen::Vector3d outer = inner;
  for (int axis = 0; axis < p.dimension; ++axis)
    if (!p.periodic[static_cast<std::size_t>(axis)]) outer[axis] += axis == 1 && p.open_top ? rows : 2 * rows;
  return outer.prod() - inner.prod();
}

}  // namespace

// Estimates the size of a case. Bytes and seconds were measured at the set-up of the cases in cases/: peak
// memory and time over the number of particles.
SizeEstimates sizes(const Parameters& p) {
  constexpr double plane = 1400, space = 2700;  // bytes of a particle, its neighbours and its equation
  constexpr double set_up_plane = 1e-6, set_up_space = 5e-6;  // [s] of a particle
  constexpr double look = 5e-9;                               // [s] for a place and each corner of the water
  const double bytes = p.dimension == 2 ? plane : space;
  const double seconds = p.dimension == 2 ? set_up_plane : set_up_space;
  const double rows = dummy_rows(p.scheme) + 1;
  const std::vector<SizeEstimate::Key> keys = {
      {"fluid.spacing", p.spacing, -static_cast<double>(p.dimension)}};
  double corners = 0;
  for (const Shape& shape : water_shapes(p)) corners += static_cast<double>(shape.size());
  corners += static_cast<double>(p.tank_polygon.size());
  // With walls off the lattice the places of the whole tank are moved by the packing.
  const bool packed = !p.tank_polygon.empty();
  return {{.what = "water particles",
           .count = water_count(p),
           .bytes_each = bytes,
           .seconds_each = seconds,
           .keys = keys},
          {.what = "wall particles",
           .count = wall_count(p, rows),
           .bytes_each = bytes,
           .seconds_each = packed ? 30 * seconds : seconds,
           .keys = {{"fluid.spacing", p.spacing, 1.0 - p.dimension}}},
          {.what = "places in the tank",
           .count = tank_lengths(p).array().prod(),
           .bytes_each = packed ? 32.0 : 1.0,
           .seconds_each = look * (1 + corners),
           .keys = keys}};
}

}  // namespace strake::fluid
