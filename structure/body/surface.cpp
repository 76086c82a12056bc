#include "structure/body/surface.hpp"

#include "proto/visible.hpp"
#include "structure/body/solid_surface.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strake::structure {
namespace {

/// Length of a segment [m], area of a triangle [m²].
double size_of(const InterfaceMesh& mesh, Eigen::Index face) {
  const auto corner = [&](Eigen::Index k) -> Eigen::Vector3d {
    return mesh.position.col(mesh.faces(k, face));
  };
  if (mesh.faces.rows() == 2) return (corner(1) - corner(0)).norm();
  return 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
}

/// Calls `visit` with each face of the surface in one of the facets, and its size. A face lies in one facet
/// with all its corners, or its middle does not; over a warped facet the middle of a triangle stands off.
template <class Visit>
void for_each_face(const Solid& solid, const std::vector<int>& facets, const InterfaceMesh& mesh,
                   const Visit& visit) {
  const Eigen::Vector3d extent = solid.node.rowwise().maxCoeff() - solid.node.rowwise().minCoeff();
  const double near = 1e-9 * extent.maxCoeff();  // [m] round-off of the coordinates, far below any spacing
  const Eigen::Index corners = mesh.faces.rows();
  std::vector<int> warped;
  for (const int facet : facets)
    if (solid.dimension == 3) {
      const Eigen::Vector3d edge =
          solid.node.col(solid.facet(1, facet)) - solid.node.col(solid.facet(0, facet));
      if (std::abs(facet_normal(solid, facet).normalized().dot(edge)) > near) warped.push_back(facet);
    }
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < corners; ++k)
      middle += mesh.position.col(mesh.faces(k, f)) / static_cast<double>(corners);
    const auto has_all = [&](int facet) {
      for (Eigen::Index k = 0; k < corners; ++k)
        if (!on_facet(solid, facet, mesh.position.col(mesh.faces(k, f)), near)) return false;
      return true;
    };
    if (std::any_of(facets.begin(), facets.end(),
                    [&](int facet) { return on_facet(solid, facet, middle, near); }) ||
        std::any_of(warped.begin(), warped.end(), has_all))
      visit(f, size_of(mesh, f));
  }
}

}  // namespace

// The plate is a union of one box.
Solid elastic_solid(const Parameters& p) {
  if (!p.solid.empty()) return p.solid;
  const Plate& plate = p.plate;
  SolidBox box;
  box.name = "plate";
  box.material = p.material;
  const double half = 0.5 * plate.length;
  box.min << plate.bottom.x() - half, plate.bottom.y(), p.shape.middle - 0.5 * p.shape.depth;
  box.max << plate.bottom.x() + half, plate.bottom.y() + plate.thickness,
      p.shape.middle + 0.5 * p.shape.depth;
  box.support[0] = plate.left;
  box.support[1] = plate.right;
  return solid_of_boxes(p.dimension, {box});
}

InterfaceMesh outline(const std::vector<Eigen::Vector2d>& polygon, double spacing) {
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 2;
  std::vector<Eigen::Vector2d> points;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const int count = std::max(1, static_cast<int>(std::lround((b - a).norm() / spacing)));
    for (int i = 0; i < count; ++i) points.emplace_back(a + static_cast<double>(i) / count * (b - a));
  }
  const auto n = static_cast<Eigen::Index>(points.size());
  mesh.position = Points::Zero(3, n);
  mesh.faces.resize(2, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    mesh.position.col(i).head<2>() = points[static_cast<std::size_t>(i)];
    mesh.faces.col(i) << static_cast<int>(i), static_cast<int>((i + 1) % n);
  }
  return mesh;
}

InterfaceMesh outline(const Plate& plate, double spacing) {
  return outline(polygon_of({}, plate, spacing), spacing);
}

std::vector<Eigen::Vector2d> polygon_of(const Shape& shape, const Plate& plate, double spacing) {
  switch (shape.kind) {
    case ShapeKind::plate: {
      const double left = plate.bottom.x() - 0.5 * plate.length,
                   right = plate.bottom.x() + 0.5 * plate.length;
      const double low = plate.bottom.y(), high = plate.bottom.y() + plate.thickness;
      return {{left, low}, {right, low}, {right, high}, {left, high}};
    }
    case ShapeKind::cylinder:
      return circle_polygon(shape.centre.head<2>(), shape.radius,
                            spacing > 0 ? spacing : 0.02 * std::numbers::pi * shape.radius);
    case ShapeKind::sphere:
    case ShapeKind::surface:
      return {};
    default:
      return shape.corner;
  }
}

InterfaceMesh surface(const Parameters& p) {
  const Shape& shape = p.shape;
  if (shape.kind == ShapeKind::sphere) return sphere_surface(shape.centre, shape.radius, p.surface_spacing);
  if (shape.kind == ShapeKind::solid && p.dimension == 3) return outer_surface(p.solid, p.surface_spacing);
  if (shape.kind == ShapeKind::surface) return refined_surface(p.closed_surface, p.surface_spacing);
  const InterfaceMesh flat = outline(polygon_of(shape, p.plate, p.surface_spacing), p.surface_spacing);
  return p.dimension == 2 ? flat : prism_surface(flat, shape.depth, shape.middle, p.surface_spacing);
}

bool is_in_body(const Parameters& p, const Eigen::Vector3d& X) {
  const Box box = bounds(p);
  const double slack = 1e-6 * (box.max - box.min).maxCoeff();
  if (p.shape.kind == ShapeKind::sphere) return (X - p.shape.centre).norm() <= p.shape.radius + slack;
  if (p.shape.kind == ShapeKind::solid) return cell_at(p.solid, X, slack) >= 0;
  if (p.shape.kind == ShapeKind::surface) return is_inside(p.closed_surface, X, slack);
  if (p.dimension == 3 && std::abs(X.z() - p.shape.middle) > 0.5 * p.shape.depth + slack) return false;
  if (p.shape.kind == ShapeKind::cylinder)
    return (X - p.shape.centre).head<2>().norm() <= p.shape.radius * (1 + 1e-2) + slack;
  const auto polygon = polygon_of(p.shape, p.plate, p.surface_spacing);
  return inside_polygon(polygon, X.head<2>()) || distance_to_polygon(polygon, X.head<2>()) <= slack;
}

Box bounds(const Parameters& p) {
  if (p.shape.kind == ShapeKind::sphere || p.shape.kind == ShapeKind::cylinder) {
    Eigen::Vector3d half = Eigen::Vector3d::Constant(p.shape.radius);
    if (p.shape.kind == ShapeKind::cylinder) half.z() = 0.5 * p.shape.depth;
    return {p.shape.centre - half, p.shape.centre + half};
  }
  if (p.shape.kind == ShapeKind::solid)
    return {p.solid.node.rowwise().minCoeff(), p.solid.node.rowwise().maxCoeff()};
  if (p.shape.kind == ShapeKind::surface)
    return {p.closed_surface.point.rowwise().minCoeff(), p.closed_surface.point.rowwise().maxCoeff()};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box box{Eigen::Vector3d::Constant(infinity), Eigen::Vector3d::Constant(-infinity)};
  for (const Eigen::Vector2d& corner : polygon_of(p.shape, p.plate, p.surface_spacing)) {
    box.min.head<2>() = box.min.head<2>().cwiseMin(corner);
    box.max.head<2>() = box.max.head<2>().cwiseMax(corner);
  }
  box.min.z() = p.shape.middle - 0.5 * p.shape.depth;
  box.max.z() = p.shape.middle + 0.5 * p.shape.depth;
  return box;
}

Eigen::VectorXd point_sizes(const InterfaceMesh& mesh) {
  Eigen::VectorXd size = Eigen::VectorXd::Zero(mesh.position.cols());
  const auto corners = mesh.faces.rows();
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const double whole = size_of(mesh, f);
    for (Eigen::Index k = 0; k < corners; ++k) size[mesh.faces(k, f)] += whole / static_cast<double>(corners);
  }
  return size;
}

Points case_force(const CaseLoad& load, const Solid& solid, const InterfaceMesh& mesh) {
  Points force = Points::Zero(3, mesh.position.cols());
  if (load.kind == LoadKind::traction) {
    const Eigen::Index corners = mesh.faces.rows();
    for_each_face(solid, facets_named(solid, load.face), mesh, [&](Eigen::Index f, double whole) {
      for (Eigen::Index k = 0; k < corners; ++k)
        force.col(mesh.faces(k, f)) += whole / static_cast<double>(corners) * load.value;
    });
  } else if (load.kind == LoadKind::point) {
    Eigen::Index nearest = 0;
    (mesh.position.colwise() - load.at).colwise().squaredNorm().minCoeff(&nearest);
    force.col(nearest) = load.value;
  }
  return force;
}

LoadedFaces loaded_faces(const Parameters& p, const InterfaceMesh& mesh) {
  const char* unit = mesh.dimension == 3 ? "m^2" : "m";
  LoadedFaces loaded;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) loaded.whole += size_of(mesh, f);
  if (p.loaded_faces.empty()) {
    loaded.size = loaded.whole;
    loaded.line = fmt::format("wet: the whole outer surface, {:.5g} {}", loaded.whole, unit);
    return loaded;
  }
  const Solid solid = elastic_solid(p);
  std::vector<int> facets;
  for (const std::string& name : p.loaded_faces) {
    const std::vector<int> named = facets_named(solid, name);
    facets.insert(facets.end(), named.begin(), named.end());
  }
  loaded.share = Eigen::VectorXd::Zero(mesh.position.cols());
  for_each_face(solid, facets, mesh, [&](Eigen::Index f, double size) {
    loaded.size += size;
    for (Eigen::Index k = 0; k < mesh.faces.rows(); ++k)
      loaded.share[mesh.faces(k, f)] += size / static_cast<double>(mesh.faces.rows());
  });
  const Eigen::VectorXd whole = point_sizes(mesh);
  for (Eigen::Index i = 0; i < whole.size(); ++i)
    if (whole[i] > 0) loaded.share[i] = std::min(1.0, loaded.share[i] / whole[i]);
  loaded.line =
      fmt::format("wet: {}, {:.5g} {} of {:.5g} {}; water that presses elsewhere is kept out and not felt",
                  joined(p.loaded_faces), loaded.size, unit, loaded.whole, unit);
  return loaded;
}

double ramp_factor(double t, double ramp) {
  if (ramp <= 0 || t >= ramp) return 1;
  return t <= 0 ? 0 : 0.5 * (1 - std::cos(std::numbers::pi * t / ramp));
}

}  // namespace strake::structure
