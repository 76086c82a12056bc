#include "structure/body/mass.hpp"

#include "structure/body/surface.hpp"

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <numbers>

namespace strake::structure {
namespace {

/// Integrals over a polygon by Green's theorem; c_i = x_i y_{i+1} − x_{i+1} y_i:
///   A = ½ Σ c_i,  ∫x = ⅙ Σ c_i (x_i + x_{i+1}),  ∫x² = 1/12 Σ c_i (x_i² + x_i x_{i+1} + x_{i+1}²),
///   ∫xy = 1/24 Σ c_i (x_i y_{i+1} + 2 x_i y_i + 2 x_{i+1} y_{i+1} + x_{i+1} y_i).
struct Moments {
  double area = 0, xx = 0, yy = 0, xy = 0;  // second moments about the centre
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
};

Moments moments_of(const std::vector<Eigen::Vector2d>& polygon) {
  Moments m;
  const Eigen::Vector2d origin = polygon.front();  // near the body, so that round-off stays small
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin, b = polygon[(i + 1) % polygon.size()] - origin;
    const double c = a.x() * b.y() - a.y() * b.x();
    m.area += c / 2;
    first += c / 6 * (a + b);
    m.xx += c / 12 * (a.x() * a.x() + a.x() * b.x() + b.x() * b.x());
    m.yy += c / 12 * (a.y() * a.y() + a.y() * b.y() + b.y() * b.y());
    m.xy += c / 24 * (a.x() * b.y() + 2 * a.x() * a.y() + 2 * b.x() * b.y() + b.x() * a.y());
  }
  const Eigen::Vector2d centre = first / m.area;
  m.xx -= m.area * centre.x() * centre.x();
  m.yy -= m.area * centre.y() * centre.y();
  m.xy -= m.area * centre.x() * centre.y();
  m.centre = origin + centre;
  return m;
}

/// A prism of this cross-section: a slab of thickness h adds m h²/12 about the axes that lie in it.
MassProperties prism(const Moments& m, double depth, double middle, double density) {
  MassProperties body;
  const double per_area = density * (depth > 0 ? depth : 1.0), thickness = depth * depth / 12;
  body.mass = per_area * m.area;
  body.centre << m.centre, middle;
  body.inertia(0, 0) = per_area * m.yy + body.mass * thickness;
  body.inertia(1, 1) = per_area * m.xx + body.mass * thickness;
  body.inertia(2, 2) = per_area * (m.xx + m.yy);
  body.inertia(0, 1) = body.inertia(1, 0) = -per_area * m.xy;
  return body;
}

}  // namespace

MassProperties mass_of(const Shape& shape, const Plate& plate, double density) {
  constexpr double pi = std::numbers::pi;
  const double r = shape.radius, r2 = r * r;
  switch (shape.kind) {
    case ShapeKind::sphere: {
      MassProperties body;
      body.mass = density * 4.0 / 3.0 * pi * r2 * r;
      body.centre = shape.centre;
      body.inertia.diagonal().setConstant(0.4 * body.mass * r2);
      return body;
    }
    case ShapeKind::cylinder:
      return prism({pi * r2, pi * r2 * r2 / 4, pi * r2 * r2 / 4, 0, shape.centre.head<2>()}, shape.depth,
                   shape.middle, density);
    default:
      return prism(moments_of(polygon_of(shape, plate, 0)), shape.depth, shape.middle, density);
  }
}

// Integrates ∫ρ dV, ∫ρ x dV, ∫ρ x xᵀ dV by three Gauss points along each axis. This is exact: x and the
// Jacobian are at most quadratic in each coordinate of a cell.
MassProperties mass_of(const Solid& solid) {
  const std::array<double, 3> point = {-std::sqrt(0.6), 0.0, std::sqrt(0.6)},
                              weight = {5 / 18.0, 8 / 18.0, 5 / 18.0};
  const int corners = static_cast<int>(solid.cell.rows()), along_z = solid.dimension == 3 ? 3 : 1;
  const Eigen::Vector3d origin = solid.node.col(0);  // near the body, so that round-off stays small
  double mass = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Eigen::Index c = 0; c < solid.cell.cols(); ++c) {
    const double density = solid.part(c).material.density;
    for (int g = 0; g < 9 * along_z; ++g) {
      const std::array<int, 3> at = {g % 3, g / 3 % 3, g / 9};
      double share = density;
      std::array<double, 3> s{};
      for (std::size_t axis = 0; axis < static_cast<std::size_t>(solid.dimension); ++axis) {
        s[axis] = 0.5 * (1 + point[static_cast<std::size_t>(at[axis])]);
        share *= weight[static_cast<std::size_t>(at[axis])];
      }
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
      J.topLeftCorner(solid.dimension, solid.dimension).setZero();
      for (int k = 0; k < corners; ++k) {
        const Eigen::Vector3d X = solid.node.col(solid.cell(k, c)) - origin;
        const auto shape = [&](int axis) {
          return (k >> axis) & 1 ? s[static_cast<std::size_t>(axis)] : 1 - s[static_cast<std::size_t>(axis)];
        };
        double whole = 1;
        for (int axis = 0; axis < solid.dimension; ++axis) whole *= shape(axis);
        x += whole * X;
        for (int axis = 0; axis < solid.dimension; ++axis) {
          double slope = (k >> axis) & 1 ? 1 : -1;
          for (int other = 0; other < solid.dimension; ++other)
            if (other != axis) slope *= shape(other);
          J.col(axis) += slope * X;
        }
      }
      share *= J.determinant();
      mass += share;
      first += share * x;
      second += share * x * x.transpose();
    }
  }
  MassProperties body;
  body.mass = mass;
  const Eigen::Vector3d centre = first / mass;
  body.centre = origin + centre;
  second -= mass * centre * centre.transpose();
  body.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return body;
}

// A tetrahedron (0, a, b, c) has the volume V = a·(b×c)/6, the first moment V s/4 with s = a + b + c, and the
// second moment V/20 (s sᵀ + a aᵀ + b bᵀ + c cᵀ).
MassProperties mass_of(const ClosedSurface& surface, double density) {
  const Eigen::Vector3d origin = surface.point.col(0);  // near the body, so that round-off stays small
  double volume = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Eigen::Index t = 0; t < surface.triangle.cols(); ++t) {
    Eigen::Matrix3d corner;
    for (Eigen::Index k = 0; k < 3; ++k) corner.col(k) = surface.point.col(surface.triangle(k, t)) - origin;
    const double V = corner.determinant() / 6;
    const Eigen::Vector3d sum = corner.rowwise().sum();
    volume += V;
    first += 0.25 * V * sum;
    second += 0.05 * V * (sum * sum.transpose() + corner * corner.transpose());
  }
  MassProperties body;
  body.mass = density * volume;
  const Eigen::Vector3d centre = first / volume;
  body.centre = origin + centre;
  second = density * (second - volume * centre * centre.transpose());
  body.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return body;
}

Eigen::Matrix3d inertia_about(const MassProperties& body, const Eigen::Vector3d& arm) {
  return body.inertia + body.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
}

MassProperties with_point_mass(const MassProperties& body, double mass, const Eigen::Vector3d& at) {
  MassProperties whole;
  whole.mass = body.mass + mass;
  whole.centre = (body.mass * body.centre + mass * at) / whole.mass;
  const MassProperties point{mass, at, Eigen::Matrix3d::Zero()};
  whole.inertia = inertia_about(body, whole.centre - body.centre) + inertia_about(point, whole.centre - at);
  return whole;
}

MassProperties mass_of(const Parameters& p) {
  MassProperties body = p.shape.kind == ShapeKind::solid     ? mass_of(p.solid)
                        : p.shape.kind == ShapeKind::surface ? mass_of(p.closed_surface, p.material.density)
                                                             : mass_of(p.shape, p.plate, p.material.density);
  const BodyMass& given = p.body;
  if (given.mass > 0) {
    body.inertia *= given.mass / body.mass;
    body.mass = given.mass;
  }
  if (given.centre) body.centre = *given.centre;
  if (given.inertia > 0) body.inertia(2, 2) = given.inertia;
  if (given.inertia_axes) body.inertia = given.inertia_axes->asDiagonal();
  if (given.lumped_mass > 0) body = with_point_mass(body, given.lumped_mass, given.lumped_at);
  return body;
}

}  // namespace strake::structure
