#include "structure/body/shape.hpp"

#include "proto/geometry/face_direction.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/solid_surface.hpp"
#include "structure/body/surface.hpp"
#include "structure/body/triangulation.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace strake::structure {
namespace shape_test {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi, degree = pi / 180;

Shape polygon(std::vector<Vector2d> corner) {
  Shape shape;
  shape.kind = ShapeKind::polygon;
  shape.corner = std::move(corner);
  return shape;
}

TEST(Shape, AWedgeHasItsDeadriseWidthAndHeight) {
  const Wedge wedge{.deadrise = 30 * degree, .width = 0.5, .height = 0.3, .apex = {0.1, 0.2, 0}};
  const auto p = wedge_polygon(wedge);
  ASSERT_EQ(p.size(), 5u);
  EXPECT_EQ(p[0], Vector2d(0.1, 0.2));
  EXPECT_NEAR(p[1].x() - p[4].x(), 0.5, 1e-15);
  EXPECT_NEAR((p[1].y() - 0.2) / 0.25, std::tan(30 * degree), 1e-14);
  EXPECT_NEAR(p[2].y() - 0.2, 0.3, 1e-15);
  EXPECT_NEAR(polygon_area(p), 0.5 * 0.3 - 0.25 * draught(wedge), 1e-15);
  EXPECT_EQ(wedge_polygon({.deadrise = pi / 4, .width = 1, .height = 0.5}).size(), 3u);  // no sides
}

TEST(Shape, WhatIsWrongWithAPolygonIsSaid) {
  const auto fault = [](std::vector<Vector2d> p) { return polygon_fault(p).problem; };
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), "");
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {0.6, 0.3}, {1, 1}, {0, 1}}), "");  // with a concave corner
  EXPECT_NE(fault({{0, 0}, {1, 1}, {1, 0}, {0, 1}}).find("crosses"), std::string::npos);
  EXPECT_NE(fault({{0, 0}, {1, 0}, {0.5, 0}, {1, 1}, {0, 1}}).find("touches"),
            std::string::npos);  // folded back
  EXPECT_NE(fault({{0, 0}, {1, 0}, {1, 1}, {0.5, 0}, {0, 1}}).find("touches"), std::string::npos);
  EXPECT_NE(fault({{0, 0}, {0, 1}, {1, 1}, {1, 0}}).find("clockwise"), std::string::npos);
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1.002, 0.001}, {0, 1}}), "");  // a short side
  EXPECT_NE(fault({{0, 0}, {1, 0}, {0, 0.05}}).find("sharp"), std::string::npos);
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), "the corner (1, 0) is given twice in a row");
  const PolygonFault closed = polygon_fault({{0, 0}, {1, 0}, {0, 1}, {0, 0}});
  EXPECT_EQ(closed.problem, "the corner (0, 0) is given twice in a row, first and last");
  EXPECT_EQ(closed.fix, "leave the last corner out: the outline closes itself");
}

TEST(Mass, PolygonsHaveTheirClosedForms) {
  // Rectangle b×h: m (b² + h²)/12. Right triangle with legs b, h: ∫ about the corner ρbh(b² + h²)/12.
  const MassProperties box = mass_of(polygon({{1, 1}, {3, 1}, {3, 2}, {1, 2}}), {}, 10);
  EXPECT_NEAR(box.mass, 20, 1e-13);
  EXPECT_LT((box.centre - Vector3d(2, 1.5, 0)).norm(), 1e-15);
  EXPECT_NEAR(box.inertia(2, 2), 20 * (4 + 1) / 12.0, 1e-13);
  const MassProperties triangle = mass_of(polygon({{0, 0}, {0.3, 0}, {0, 0.4}}), {}, 1000);
  EXPECT_NEAR(triangle.mass, 60, 1e-13);
  EXPECT_LT((triangle.centre - Vector3d(0.1, 0.4 / 3, 0)).norm(), 1e-15);
  EXPECT_NEAR(inertia_about(triangle, -triangle.centre)(2, 2), 1000 * 0.12 * 0.25 / 12, 1e-13);
  const Plate plate{.length = 0.4, .thickness = 0.02, .bottom = {5, 5, 0}};
  EXPECT_NEAR(mass_of(Shape{}, plate, 7800).inertia(2, 2), 62.4 * (0.16 + 0.0004) / 12, 1e-11);
}

TEST(Mass, AConcavePolygonIsTheDifferenceOfItsParts) {
  const auto part = [](std::vector<Vector2d> p) { return mass_of(polygon(std::move(p)), {}, 1); };
  const MassProperties ell = part({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  const MassProperties whole = part({{0, 0}, {2, 0}, {2, 2}, {0, 2}}),
                       cut = part({{1, 1}, {2, 1}, {2, 2}, {1, 2}});
  EXPECT_NEAR(ell.mass, 3, 1e-15);
  EXPECT_LT((ell.mass * ell.centre - (whole.mass * whole.centre - cut.mass * cut.centre)).norm(), 1e-14);
  const auto about_origin = [](const MassProperties& m) { return inertia_about(m, m.centre)(2, 2); };
  EXPECT_NEAR(about_origin(ell), about_origin(whole) - about_origin(cut), 1e-13);
}

TEST(Mass, CylinderSphereAndPrismHaveTheirClosedForms) {
  Shape round;
  round.kind = ShapeKind::cylinder;
  round.radius = 0.2;
  const MassProperties flat = mass_of(round, {}, 500);
  EXPECT_NEAR(flat.mass, 500 * pi * 0.04, 1e-12);
  EXPECT_NEAR(flat.inertia(2, 2), 0.5 * flat.mass * 0.04, 1e-13);
  round.depth = 0.6;
  const MassProperties long_one = mass_of(round, {}, 500);
  EXPECT_NEAR(long_one.inertia(0, 0), long_one.mass * (3 * 0.04 + 0.36) / 12, 1e-12);
  round.kind = ShapeKind::sphere;
  EXPECT_NEAR(mass_of(round, {}, 500).inertia(1, 1), 0.4 * mass_of(round, {}, 500).mass * 0.04, 1e-14);
  Shape prism = polygon({{0, 0}, {0.3, 0}, {0, 0.4}});
  prism.depth = 2;
  const MassProperties m = mass_of(prism, {}, 1000);
  EXPECT_NEAR(m.mass, 120, 1e-12);
  // Right triangle with legs b, h about its centre: ∫x² = b³h/36, ∫xy = −b²h²/72.
  EXPECT_NEAR(m.inertia(1, 1), 2000 * 0.027 * 0.4 / 36 + 120 * 4 / 12.0, 1e-12);
  EXPECT_NEAR(m.inertia(0, 1), 2000 * 0.09 * 0.16 / 72, 1e-12);
}

TEST(Mass, APointMassShiftsCentreAndInertia) {
  Parameters p;
  p.plate = {.length = 1, .thickness = 0.1, .bottom = {0, 0, 0}};
  p.body.mass = 3;
  p.body.inertia = 0.5;
  p.body.lumped_mass = 1;
  p.body.lumped_at = {0.4, 0.05, 0};
  const MassProperties m = mass_of(p);
  EXPECT_NEAR(m.mass, 4, 1e-15);
  EXPECT_NEAR(m.centre.x(), 0.1, 1e-15);
  EXPECT_NEAR(m.inertia(2, 2), 0.5 + 3 * 0.01 + 1 * 0.09, 1e-15);  // Σ m a²
}

TEST(Surface, ACircleHasItsAreaAndTurnsTooLittleForCorners) {
  const auto circle = circle_polygon({1, 2}, 0.1, 0.01);
  EXPECT_NEAR(polygon_area(circle), pi * 0.01, 1e-15);
  EXPECT_EQ(circle.size() % 4, 0u);
  EXPECT_GE(circle_polygon({0, 0}, 0.1, 0.1).size(), 24u);  // 15 degrees at most
}

/// Each edge of a closed surface belongs to two triangles, once in each direction.
void expect_closed(const InterfaceMesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) ++edges[{mesh.faces(k, f), mesh.faces((k + 1) % 3, f)}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
}

TEST(SolidSurface, APrismIsClosedFacesOutAndHasItsVolumeAndSurface) {
  const std::vector<Vector2d> ell = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const InterfaceMesh mesh = prism_surface(outline(ell, 0.1), 0.75, 0.2, 0.1);
  expect_closed(mesh);
  EXPECT_NEAR(enclosed_volume(mesh.faces, mesh.position), 3 * 0.75, 1e-12);
  EXPECT_NEAR(point_sizes(mesh).sum(), 2 * 3 + 8 * 0.75, 1e-12);
  EXPECT_NEAR(mesh.position.row(2).minCoeff(), 0.2 - 0.375, 1e-15);
  // Triangles of about the spacing: none is a sliver and none is large.
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Vector3d a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f)),
                   c = mesh.position.col(mesh.faces(2, f));
    EXPECT_LE(std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}), 0.1501);
    EXPECT_GE((b - a).cross(c - a).norm() / 2, 0.08 * 0.01);
  }
}

TEST(SolidSurface, AWedgePrismIsClosedAtItsSharpEnds) {
  Parameters p;
  p.dimension = 3;
  p.surface_spacing = 0.02;
  p.shape.kind = ShapeKind::wedge;
  p.shape.corner =
      wedge_polygon({.deadrise = 10 * degree, .width = 0.5, .height = 0.25 * std::tan(10 * degree)});
  p.shape.depth = 0.3;
  const InterfaceMesh mesh = surface(p);
  expect_closed(mesh);
  EXPECT_NEAR(enclosed_volume(mesh.faces, mesh.position), 0.0625 * std::tan(10 * degree) * 0.3, 1e-14);
}

TEST(SolidSurface, ASphereIsClosedAndHasItsVolume) {
  const InterfaceMesh mesh = sphere_surface({1, 2, 3}, 0.5, 0.1);
  expect_closed(mesh);
  EXPECT_EQ(mesh.position.cols(), 2 + mesh.faces.cols() / 2);  // Euler
  EXPECT_NEAR(enclosed_volume(mesh.faces, mesh.position), 4.0 / 3 * pi * 0.125, 1e-13);
  EXPECT_LT((mesh.position.rowwise().mean() - Vector3d(1, 2, 3)).norm(), 1e-14);
  EXPECT_NEAR(point_sizes(mesh).sum() / pi, 1, 0.02);  // chords
}

TEST(Triangulation, FillsAPolygonWithPointsOnLongStraightEdges) {
  std::vector<Vector2d> p;
  for (int i = 0; i < 30; ++i) p.emplace_back(i * 0.1, 0);
  for (int i = 0; i < 10; ++i) p.emplace_back(3, i * 0.1);
  for (int i = 30; i > 0; --i) p.emplace_back(i * 0.1, 1);
  for (int i = 10; i > 0; --i) p.emplace_back(0, i * 0.1);
  const Triangulation t = triangulate(p, 0.1);
  double area = 0;
  for (const auto& [a, b, c] : t.triangle) {
    const Vector2d u = t.point[static_cast<std::size_t>(b)] - t.point[static_cast<std::size_t>(a)],
                   v = t.point[static_cast<std::size_t>(c)] - t.point[static_cast<std::size_t>(a)];
    const double twice = u.x() * v.y() - u.y() * v.x();
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_NEAR(area, 3, 1e-13);
  EXPECT_GT(t.point.size(), p.size() + 100);
}

}  // namespace shape_test
}  // namespace strake::structure
