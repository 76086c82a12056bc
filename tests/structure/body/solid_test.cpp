#include "structure/body/solid.hpp"

#include "proto/error.hpp"
#include "proto/geometry/face_direction.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/shape.hpp"
#include "structure/body/surface.hpp"
#include "structure/body/wall.hpp"
#include "tests/structure/body/boxes.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure {
namespace body_solid_test {

using Eigen::Vector3d;

SolidBox light_box(const std::string& name, const Vector3d& min, const Vector3d& max) {
  return box(name, min, max, {.density = 1000});
}

/// A closed box section in the plane, 0.3 × 0.08 m, walls of 10 mm, one rib in its middle.
std::vector<SolidBox> hull() {
  return {light_box("bottom", {-0.15, 0, 0}, {0.15, 0.01, 0}),
          light_box("deck", {-0.15, 0.07, 0}, {0.15, 0.08, 0}),
          light_box("left", {-0.15, 0.01, 0}, {-0.14, 0.07, 0}),
          light_box("right", {0.14, 0.01, 0}, {0.15, 0.07, 0}),
          light_box("rib", {-0.005, 0.01, 0}, {0.005, 0.07, 0})};
}

/// A section of two panels that meet in a keel, 0.25 m to each side, as cells of a mesh.
Solid v_section(double slope, double thickness) {
  constexpr int cells = 20;
  Solid solid;
  solid.node = Points::Zero(3, 2 * (2 * cells + 1));
  for (int k = -cells; k <= cells; ++k) {
    const double x = 0.25 * k / cells;
    solid.node.col(2 * (k + cells)) << x, std::abs(x) * slope, 0;
    solid.node.col(2 * (k + cells) + 1) << x, std::abs(x) * slope + thickness * std::hypot(1, slope), 0;
  }
  solid.cell.resize(4, 2 * cells);
  for (int c = 0; c < 2 * cells; ++c) solid.cell.col(c) << 2 * c, 2 * c + 2, 2 * c + 1, 2 * c + 3;
  solid.part_of.assign(2 * cells, 0);
  solid.parts = {{"panels", {}, false}};
  find_facets(solid);
  return solid;
}

// The box around the section is 72 mm high: its least side says nothing of the panels.
TEST(Solid, ThicknessOfWallsAndTheSpacingOfTheirParticles) {
  const Solid v = v_section(std::tan(0.26), 0.005);
  EXPECT_NEAR(wall_thickness(v), 0.005, 1e-9);
  EXPECT_NEAR(particle_spacing(v), 0.00125, 1e-9);
  EXPECT_NEAR(particle_spacing(solid_of_boxes(2, hull())), 0.0025, 1e-12);
  const auto plate = [](double length, double thickness) {
    return solid_of_boxes(2, {light_box("plate", {0, 0, 0}, {length, thickness, 0})});
  };
  EXPECT_NEAR(particle_spacing(plate(0.4, 0.02)), 0.005, 1e-12);
  EXPECT_NEAR(particle_spacing(plate(0.4, 0.012)), 0.002, 1e-12);   // six layers fill it
  EXPECT_NEAR(particle_spacing(plate(0.401, 0.02)), 0.005, 1e-12);  // 20 would: it is refused with a remedy
  EXPECT_NEAR(particle_spacing(plate(0.4, 0.2)), 0.01, 1e-12);      // a block: forty along it
  const Solid space = solid_of_boxes(3, {light_box("panel", {0, 0, 0}, {0.4, 0.02, 0.3})});
  EXPECT_NEAR(particle_spacing(space), 0.005, 1e-12);
}

TEST(Solid, OneBoxHasTheOutlineOfThePlate) {
  const Plate plate{.length = 0.4, .thickness = 0.02, .bottom = {0, 0.012, 0}};
  const Solid solid = solid_of_boxes(2, {light_box("plate", {-0.2, 0.012, 0}, {0.2, 0.032, 0})});
  ASSERT_EQ(solid.cell.cols(), 1);
  ASSERT_EQ(solid.facet.cols(), 4);
  const auto polygons = outer_polygons(solid);
  ASSERT_EQ(polygons.size(), 1U);
  const auto expected = polygon_of({}, plate, 0);
  ASSERT_EQ(polygons[0].size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR((polygons[0][i] - expected[i]).norm(), 0, 1e-15);
}

TEST(Solid, AClosedHullIsWetOutsideOnly) {
  const Solid solid = solid_of_boxes(2, hull());
  EXPECT_TRUE(fault_of(solid).problem.empty()) << fault_of(solid).problem;
  const auto polygons = outer_polygons(solid);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(polygons[0].size(), 4U) << "planes of the rib do not cut the outline";
  EXPECT_NEAR(polygon_area(polygons[0]), 0.3 * 0.08, 1e-15);
}

TEST(Solid, AnOpenHullIsWetInsideToo) {
  std::vector<SolidBox> open = hull();
  open.erase(open.begin() + 1);
  const auto polygons = outer_polygons(solid_of_boxes(2, open));
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_EQ(polygons[0].size(), 12U);
  EXPECT_NEAR(polygon_area(polygons[0]), 0.3 * 0.01 + 3 * 0.01 * 0.06, 1e-15);
}

TEST(Solid, MassAndInertiaAreThoseOfTheParts) {
  std::vector<SolidBox> parts = hull();
  parts[4].material.density = 3000;
  const MassProperties body = mass_of(solid_of_boxes(2, parts));
  double mass = 0, moment = 0, inertia = 0;
  for (const SolidBox& b : parts) {
    const Vector3d size = b.max - b.min, centre = 0.5 * (b.min + b.max);
    const double m = b.material.density * size.x() * size.y();
    mass += m;
    moment += m * centre.y();
    inertia += m * (size.head<2>().squaredNorm() / 12 + centre.squaredNorm());
  }
  EXPECT_NEAR(body.mass, mass, 1e-12 * mass);
  EXPECT_NEAR(body.centre.y(), moment / mass, 1e-15);
  EXPECT_NEAR(body.inertia(2, 2), inertia - mass * body.centre.squaredNorm(), 1e-12 * inertia);
}

TEST(Solid, WhereBoxesOverlapTheFirstOneCounts) {
  const Solid solid =
      solid_of_boxes(2, {light_box("a", {0, 0, 0}, {2, 1, 0}), light_box("b", {1, 0, 0}, {3, 1, 0})});
  ASSERT_EQ(solid.cell.cols(), 3);
  EXPECT_EQ(solid.part_of, (std::vector<int>{0, 0, 1}));
}

TEST(Solid, PartsThatTouchInACornerOnlyAreNamed) {
  const Solid solid =
      solid_of_boxes(2, {light_box("floor", {0, 0, 0}, {1, 1, 0}), light_box("stray", {1, 1, 0}, {2, 2, 0})});
  const SolidFault fault = fault_of(solid);
  EXPECT_NE(fault.problem.find("\"stray\""), std::string::npos) << fault.problem;
  EXPECT_EQ(outer_polygons(solid).size(), 2U);
}

TEST(Solid, ASupportOfACoveredFaceHoldsNothing) {
  std::vector<SolidBox> parts = hull();
  parts[4].support[2] = Support::clamped;  // the rib's foot stands on the bottom
  const SolidFault fault = fault_of(solid_of_boxes(2, parts));
  EXPECT_NE(fault.problem.find("rib.bottom"), std::string::npos) << fault.problem;
}

TEST(Solid, ASupportIsTheSideOfItsOwnBox) {
  std::vector<SolidBox> parts = hull();
  parts[2].support[0] = Support::clamped;
  const Solid solid = solid_of_boxes(2, parts);
  ASSERT_EQ(solid.supported.size(), 1U);
  const SupportedFace& face = solid.supported[0];
  ASSERT_FALSE(face.facet.empty());
  EXPECT_NEAR((middle_of(solid, face) - Vector3d(-0.15, 0.04, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((normal_of(solid, face) - Vector3d(-1, 0, 0)).norm(), 0, 1e-15);
  EXPECT_TRUE(on_facet(solid, face.facet[0], {-0.15, 0.02, 0}, 1e-9));
  EXPECT_FALSE(on_facet(solid, face.facet[0], {-0.15, 0.005, 0}, 1e-9)) << "that is the bottom's side";
}

TEST(Solid, ASolidBoxOfThreeDimensionsHasAClosedSurface) {
  std::vector<SolidBox> parts = {light_box("slab", {0, 0, 0}, {1, 0.1, 0.5}),
                                 light_box("rib", {0.4, 0.1, 0}, {0.5, 0.3, 0.5})};
  const Solid solid = solid_of_boxes(3, parts);
  EXPECT_TRUE(fault_of(solid).problem.empty());
  const InterfaceMesh mesh = outer_surface(solid, 0.05);
  EXPECT_NEAR(enclosed_volume(mesh.faces, mesh.position), 0.05 + 0.01, 1e-12);
  EXPECT_NEAR(mass_of(solid).mass, 1000 * 0.06, 1e-9);
  // closed: the vector areas cancel
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Vector3d a = mesh.position.col(mesh.faces(0, f)), b = mesh.position.col(mesh.faces(1, f)),
                   c = mesh.position.col(mesh.faces(2, f));
    sum += 0.5 * (b - a).cross(c - a);
  }
  EXPECT_NEAR(sum.norm(), 0, 1e-14);
}

TEST(Solid, ACavityOfThreeDimensionsIsDry) {
  std::vector<SolidBox> parts;
  const double t = 0.1;
  parts.push_back(light_box("bottom", {0, 0, 0}, {1, t, 1}));
  parts.push_back(light_box("top", {0, 1 - t, 0}, {1, 1, 1}));
  parts.push_back(light_box("left", {0, t, 0}, {t, 1 - t, 1}));
  parts.push_back(light_box("right", {1 - t, t, 0}, {1, 1 - t, 1}));
  parts.push_back(light_box("back", {t, t, 0}, {1 - t, 1 - t, t}));
  parts.push_back(light_box("front", {t, t, 1 - t}, {1 - t, 1 - t, 1}));
  const Solid solid = solid_of_boxes(3, parts);
  const InterfaceMesh outer = outer_surface(solid, 0.25);
  EXPECT_NEAR(enclosed_volume(outer.faces, outer.position), 1, 1e-12);
  EXPECT_NEAR(mass_of(solid).mass, 1000 * (1 - 0.8 * 0.8 * 0.8), 1e-9);
  EXPECT_EQ(cell_at(solid, {0.5, 0.5, 0.5}, 1e-9), -1);
  EXPECT_GE(cell_at(solid, {0.05, 0.5, 0.5}, 1e-9), 0);
}

TEST(Solid, TurnedBoxesKeepTheNamesOfTheirSides) {
  Solid solid = solid_of_boxes(
      3, {soft_box("skin", {0, 0, 0}, {1, 0.1, 1}), soft_box("bar", {0.4, 0.1, 0}, {0.5, 0.4, 1})});
  const auto bottom = facets_named(solid, "bottom"), skin = facets_named(solid, "skin.left"),
             bar = facets_named(solid, "bar.top");
  ASSERT_FALSE(bottom.empty() || skin.empty() || bar.empty());
  solid.turn = Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  solid.node = solid.turn * solid.node;
  EXPECT_EQ(facets_named(solid, "bottom"), bottom);
  EXPECT_EQ(facets_named(solid, "skin.left"), skin);
  EXPECT_EQ(facets_named(solid, "bar.top"), bar);
  EXPECT_TRUE(facets_named(solid, "keel").empty());
}

// Places of the bilinear surface between the corners of a facet lie on it, also where it is warped.
TEST(Solid, PlacesLieOnAWarpedFacetOrBesideIt) {
  const Solid solid = warped_bar(0.01);
  for (const SupportedFace& face : solid.supported)
    for (const int f : face.facet) {
      const auto corner = [&](Eigen::Index k) -> Vector3d { return solid.node.col(solid.facet(k, f)); };
      const Vector3d normal = facet_normal(solid, f).normalized();
      ASSERT_GT(std::abs(normal.dot(corner(1) - corner(0))), 1e-3) << "it is warped";
      for (const double s : {0.0, 0.3, 1.0})
        for (const double r : {0.0, 0.5, 0.9}) {
          const Vector3d X = (1 - s) * (1 - r) * corner(0) + s * (1 - r) * corner(1) + s * r * corner(2) +
                             (1 - s) * r * corner(3);
          EXPECT_TRUE(on_facet(solid, f, X, 1e-12)) << face.name << " " << s << " " << r;
          EXPECT_GE(cell_at(solid, X, 1e-12), 0);
          for (const double off : {-1e-6, 1e-6}) EXPECT_FALSE(on_facet(solid, f, X + off * normal, 1e-9));
        }
      EXPECT_FALSE(on_facet(solid, f, 1.2 * corner(1) - 0.2 * corner(0), 1e-9)) << "beside its edge";
    }
}

// The shorter direction of a face is along its own edge, however the body lies; a roller needs an axis.
TEST(Solid, TheShorterDirectionOfAFaceIsThatOfItsEdge) {
  SolidBox plate = soft_box("plate", {0, 0, 0}, {1, 0.05, 0.4});
  plate.support[0] = Support::pinned;
  const Solid level = solid_of_boxes(3, {plate});
  EXPECT_NEAR(std::abs(shorter_direction(level, level.supported[0]).y()), 1, 1e-12);
  EXPECT_EQ(axis_of(level, level.supported[0]), 0);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix();
  for (const bool of_mesh : {false, true}) {  // a mesh file may hold the turned plate
    Solid turned = level;
    turned.node = turn * level.node;
    if (of_mesh)
      turned.plane = {};
    else
      turned.turn = turn;
    EXPECT_NEAR(std::abs(shorter_direction(turned, turned.supported[0]).dot(turn.col(1))), 1, 1e-12);
    EXPECT_THROW(axis_of(turned, turned.supported[0]), Error) << "what rolls needs axes";
  }
}

}  // namespace body_solid_test
}  // namespace strake::structure
