#include "structure/mass.hpp"

#include "structure/surface.hpp"

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
  MassProperties body = mass_of(p.shape, p.plate, p.material.density);
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
