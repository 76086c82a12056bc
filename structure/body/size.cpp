#include "structure/body/size.hpp"

#include "structure/body/mass.hpp"
#include "structure/body/surface.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

/// Lengths of which a surface's size is made [m], [m²].
struct Outer {
  double round = 0;    // perimeter of the section in the plane
  double section = 0;  // its area
  double surface = 0;  // in three dimensions all of the outer surface
};

Outer outer_of_facets(const Solid& solid) {
  double sum = 0;
  for (int f = 0; f < solid.facet.cols(); ++f) sum += facet_normal(solid, f).norm();
  return {.round = sum, .section = 0, .surface = sum};
}

Outer outer_of(const Parameters& p) {
  const Shape& shape = p.shape;
  constexpr double pi = std::numbers::pi;
  if (shape.kind == ShapeKind::solid) return outer_of_facets(p.solid);
  if (shape.kind == ShapeKind::surface) return {.surface = outer_area(p.closed_surface)};
  Outer outer;
  if (shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::cylinder) {
    outer = {.round = 2 * pi * shape.radius, .section = pi * shape.radius * shape.radius};
  } else {
    const auto polygon = polygon_of(shape, p.plate, 0);
    for (std::size_t i = 0; i < polygon.size(); ++i)
      outer.round += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
    outer.section = std::abs(polygon_area(polygon));
  }
  outer.surface =
      shape.kind == ShapeKind::sphere ? 4 * outer.section : outer.round * shape.depth + 2 * outer.section;
  return outer;
}

double volume_of(Solid solid) {
  for (Part& part : solid.parts) part.material.density = 1;
  return mass_of(solid).mass;
}

double ball(int dimension, double radius) {
  return dimension == 2 ? std::numbers::pi * radius * radius
                        : 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
}

/// Lengths of the body that the case gives, so that an error can name them.
std::vector<SizeEstimate::Key> lengths(const Parameters& p) {
  if (p.shape.kind != ShapeKind::plate) return {};
  std::vector<SizeEstimate::Key> keys = {{"structure.plate.length", p.plate.length, 1}};
  if (p.dimension == 3) keys.push_back({"structure.depth", p.shape.depth, 1});
  return keys;
}

void add(std::vector<SizeEstimate::Key>& keys, const std::vector<SizeEstimate::Key>& more) {
  keys.insert(keys.end(), more.begin(), more.end());
}

}  // namespace

SizeEstimate surface_size(const Parameters& p, double cells) {
  // Measured as peak memory and time of --check. The case is the sphere of cases/sphere_entry_3d.toml with up
  // to 450 000 points; a figure is for one point in space and its mapping. The search: the plate of
  // cases/plate_entry.toml, 40 m long.
  constexpr double bytes = 500, seconds = 2e-6;
  constexpr double compare = 5e-8;  // [s] of one point with one cell, or one corner with another
  const Outer outer = outer_of(p);
  const double spacing = p.surface_spacing, round = outer.round / spacing;
  SizeEstimate points{.what = "points of the surface", .count = round, .bytes_each = bytes};
  // The ends of a prism are cut into triangles; this compares each point of the rim with all others.
  const bool of_triangles = p.shape.kind == ShapeKind::surface;
  const bool prism = p.dimension == 3 && p.shape.kind != ShapeKind::solid &&
                     p.shape.kind != ShapeKind::sphere && !of_triangles;
  if (p.dimension == 3) points.count = 1.2 * outer.surface / (spacing * spacing);
  if (of_triangles) points.count = refined_count(p.closed_surface, spacing);
  points.seconds_each = seconds + compare * (cells + (prism ? round * round / points.count : 0));
  points.keys = {{"structure.surface_spacing", spacing, p.dimension == 2 ? -1.0 : -2.0}};
  add(points.keys, lengths(p));
  return points;
}

SizeEstimates surface_sizes(const Parameters& p) {
  return {surface_size(p)};
}

SizeEstimates lattice_sizes(const Parameters& p) {
  // Memory and time of one particle with its bonds, measured as peak memory and time of --check. The case is
  // the plate of cases/plate_entry.toml, radius 2.1, with 20 000 particles in the plane and 26 000 in space.
  constexpr double bond_bytes = 50, own_bytes = 100, seconds = 2.5e-4;
  const Solid solid = elastic_solid(p);
  const int dim = p.dimension;
  const double d = p.particle.spacing, cell = std::pow(d, dim);
  const double bonds = ball(dim, p.particle.radius);
  const Eigen::Vector3d extent = solid.node.rowwise().maxCoeff() - solid.node.rowwise().minCoeff();
  const double box = extent.head(dim).array().prod();
  const std::string key = p.interface == "volume" ? "fluid.spacing" : "structure.particle.spacing";
  std::vector<SizeEstimate::Key> keys = {{key, d, -static_cast<double>(dim)}};
  add(keys, lengths(p));
  SizeEstimates all = {{.what = fmt::format("particles of the structure {:.3g} mm apart", 1e3 * d),
                        .count = volume_of(solid) / cell,
                        .bytes_each = own_bytes + bond_bytes * bonds,
                        .seconds_each = seconds,
                        .keys = keys},
                       {.what = "places of its lattice", .count = box / cell, .bytes_each = 4, .keys = keys}};
  if (!solid.along_axes()) {
    constexpr double bytes = 2, seconds = 2e-8;  // of a sample
    all.push_back({.what = "samples of its volume",
                   .count = 64 * box / cell,
                   .bytes_each = bytes,
                   .seconds_each = seconds,
                   .keys = keys});
  }
  return all;
}

SizeEstimates particle_sizes(const Parameters& p) {
  SizeEstimates all = lattice_sizes(p);
  all.push_back(surface_size(p));
  return all;
}

}  // namespace strake::structure
