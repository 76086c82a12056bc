#include "structure/body/wall.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace strake::structure {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// A ray's way [m] from a place to a facet of the plane or to a triangle; infinite if it passes by.
double way_to_segment(const Vector3d& from, const Vector3d& along, const Vector3d& a, const Vector3d& b) {
  const Vector3d side = b - a, gap = a - from;
  const double area = along.x() * side.y() - along.y() * side.x();
  const double s = (gap.x() * side.y() - gap.y() * side.x()) / area,
               t = (gap.x() * along.y() - gap.y() * along.x()) / area;
  const bool meets = area != 0 && t >= 0 && t <= 1;
  return meets ? s : std::numeric_limits<double>::infinity();
}
double way_to_triangle(const Vector3d& from, const Vector3d& along, const Vector3d& a, const Vector3d& b,
                       const Vector3d& c) {
  const Vector3d u = b - a, v = c - a, gap = from - a, cross = along.cross(v), other = gap.cross(u);
  const double volume = u.dot(cross);
  const double s = gap.dot(cross) / volume, t = along.dot(other) / volume;
  const bool meets = volume != 0 && s >= 0 && t >= 0 && s + t <= 1;
  return meets ? v.dot(other) / volume : std::numeric_limits<double>::infinity();
}

/// Length of a ray inside the body from the middle of a facet on, against its normal [m].
double way_through(const Solid& solid, Index facet) {
  const auto corner = [&](Index f, Index k) -> Vector3d { return solid.node.col(solid.facet(k, f)); };
  Vector3d middle = Vector3d::Zero();
  for (Index k = 0; k < solid.facet.rows(); ++k)
    middle += corner(facet, k) / static_cast<double>(solid.facet.rows());
  const Vector3d inwards = -facet_normal(solid, static_cast<int>(facet)).normalized();
  double way = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < solid.facet.cols(); ++f) {
    if (f == facet) continue;
    const auto reach = [&](double s) {
      if (s > 0) way = std::min(way, s);
    };
    if (solid.dimension == 2) {
      reach(way_to_segment(middle, inwards, corner(f, 0), corner(f, 1)));
    } else {
      reach(way_to_triangle(middle, inwards, corner(f, 0), corner(f, 1), corner(f, 2)));
      reach(way_to_triangle(middle, inwards, corner(f, 0), corner(f, 2), corner(f, 3)));
    }
  }
  return way;
}

}  // namespace

double common_measure(const Solid& solid) {
  double measure = 0;
  for (const std::vector<double>& plane : solid.plane)
    for (std::size_t k = 1; k < plane.size(); ++k) {
      double a = plane[k] - plane[k - 1], b = measure;
      const double round_off = 1e-7 * a;
      while (b > round_off) {  // Euclid
        const double rest = a - b * std::floor(a / b + 1e-7);
        a = b;
        b = std::max(rest, 0.0);
      }
      measure = a;
    }
  return measure;
}

double wall_thickness(const Solid& solid) {
  if (solid.made_of_boxes()) return thinnest(solid);
  constexpr Index rays = 400;
  constexpr double share = 0.1;
  const Index step = std::max<Index>(1, solid.facet.cols() / rays);
  std::vector<std::pair<double, double>> ways;  // of a ray, and the size of its facet
  double whole = 0;
  for (Index f = 0; f < solid.facet.cols(); f += step) {
    const double size = facet_normal(solid, static_cast<int>(f)).norm();
    ways.emplace_back(way_through(solid, f), size);
    whole += size;
  }
  std::sort(ways.begin(), ways.end());
  double passed = 0;
  for (const auto& [way, size] : ways)
    if ((passed += size) >= share * whole) return way;
  return thinnest(solid);
}

double particle_spacing(const Solid& solid) {
  constexpr double layers = 4, most_layers = 10, along = 40;
  const double thin = wall_thickness(solid), longest = part_sizes(solid).topRows(solid.dimension).maxCoeff();
  const double spacing = std::min(thin / layers, longest / along);
  if (!solid.along_axes()) return spacing;
  const double measure = common_measure(solid), fitting = measure / std::ceil(measure / spacing * (1 - 1e-6));
  return spacing / fitting * layers <= most_layers ? fitting : spacing;
}

}  // namespace strake::structure
