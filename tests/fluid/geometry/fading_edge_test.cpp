// The stem and the keel's ends of a hull with a round bottom: edges that end in a smooth surface.

#include "fluid/geometry/body_surface_3d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace strake::fluid {
namespace fading_edge_test {

using Eigen::Vector3d;

constexpr double l0 = 0.02, reach = 3.1 * l0;
constexpr double length = 1.0, breadth = 0.24, draught = 0.12, freeboard = 0.1;

/// Half the breadth of Wigley's hull, y up and z to the side:
///   z = B/2 (1 − (2x/L)²)(1 − (y/D)²), above y = 0 with upright sides.
double half_breadth(double x, double y) {
  const double below = std::min(y, 0.0) / draught;
  return 0.5 * breadth * (1 - 4 * x * x / (length * length)) * (1 - below * below);
}

/// The hull with a flat deck. Amidships its keel turns by 53 degrees, at the ends by 130 and more.
InterfaceMesh hull() {
  constexpr int stations = 24, waterlines = 8;
  std::map<std::pair<std::pair<int, int>, int>, int> known;  // station, waterline, side
  std::vector<Vector3d> place;
  std::vector<Eigen::Vector3i> triangle;
  const auto point = [&](int i, int j, int side) {
    const double x = length * i / stations - 0.5 * length;
    const double y = j <= 6 ? draught * (j / 6.0 - 1) : freeboard * (j - 6) / (waterlines - 6);
    if (i == 0 || i == stations || j == 0) side = 0;
    const auto [found, is_new] = known.try_emplace({{i, j}, side}, static_cast<int>(place.size()));
    if (is_new) place.push_back({x, y, side * half_breadth(x, y)});
    return found->second;
  };
  const auto add = [&](int a, int b, int c) {
    if (a != b && b != c && c != a) triangle.push_back({a, b, c});
  };
  for (int i = 0; i < stations; ++i) {
    for (int j = 0; j < waterlines; ++j)
      for (const int side : {1, -1}) {
        const int a = point(i, j, side), b = point(i + 1, j, side), c = point(i + 1, j + 1, side),
                  d = point(i, j + 1, side);
        const auto add_turned = [&](int p, int q, int r) { add(side > 0 ? p : q, side > 0 ? q : p, r); };
        const bool aft = 2 * i < stations;  // diagonals that leave no triangle in the plane of symmetry
        add_turned(a, b, aft ? c : d);
        add_turned(aft ? a : b, c, d);
      }
    const int deck = waterlines;
    add(point(i, deck, 1), point(i + 1, deck, 1), point(i + 1, deck, -1));
    add(point(i, deck, 1), point(i + 1, deck, -1), point(i, deck, -1));
  }
  InterfaceMesh mesh{.name = "hull", .position = Points(3, place.size()), .faces = {}, .mass = {}};
  for (std::size_t k = 0; k < place.size(); ++k) mesh.position.col(static_cast<Eigen::Index>(k)) = place[k];
  mesh.faces.resize(3, static_cast<Eigen::Index>(triangle.size()));
  for (std::size_t t = 0; t < triangle.size(); ++t)
    mesh.faces.col(static_cast<Eigen::Index>(t)) = triangle[t];
  return mesh;
}

const BodySurface3d& hull_in_water() {
  static const BodySurface3d body(hull(), l0, reach, knuckles_under_water);
  return body;
}

/// The wet point nearest to x, on its side.
int wet_point(const BodySurface3d& body, const Vector3d& x) {
  int nearest = -1;
  for (int k = 0; k < body.points(); ++k)
    if (body.point(k).z() * x.z() > 0 &&
        (nearest < 0 || (body.point(k) - x).norm() < (body.point(nearest) - x).norm()))
      nearest = k;
  return nearest;
}

TEST(FadingEdge, SidesOfAStemHaveTheirOwnWetPointsAndNormals) {
  const BodySurface3d& body = hull_in_water();
  double area[2] = {};
  int near_stem = 0;
  for (int k = 0; k < body.points(); ++k) {
    const Vector3d x = body.point(k), n = body.normal(k);
    area[x.z() > 0] += body.area(k);
    if (std::abs(x.x()) < 0.46 || std::abs(n.y()) > 0.8) continue;  // that near; and not of the deck
    ++near_stem;
    EXPECT_GT(n.z() * (x.z() > 0 ? 1 : -1), 0.7) << x.transpose() << ": " << n.transpose();
    EXPECT_GT(n.dot(body.area_vector(k).normalized()), 0.9) << x.transpose();
    EXPECT_GT(body.area(k), 0.2 * l0 * l0) << x.transpose();
  }
  EXPECT_GT(near_stem, 60);
  EXPECT_NEAR(area[0], area[1], 0.02 * area[0]);
}

TEST(FadingEdge, AFaceEndsAtTheStem) {
  const BodySurface3d& body = hull_in_water();
  for (const int side : {1, -1}) {
    const Vector3d aside(0, 0, side), foot(0.48, -0.03, side * half_breadth(0.48, -0.03));
    const int k = wet_point(body, foot);
    EXPECT_TRUE(body.faces(k, foot + 0.5 * l0 * aside));
    EXPECT_FALSE(body.faces(k, Vector3d(0.51, -0.03, 0.1 * side * l0))) << "before the stem";
    EXPECT_NEAR(body.within(k, foot), 0.02, 0.003);  // on the way to x = L/2
    // Water on one side does not look through the stem at the layers of the other.
    const Vector3d other = foot - 2 * foot.z() * Vector3d::UnitZ();
    EXPECT_FALSE(body.crosses(k, body.near(other - 0.5 * l0 * aside, reach).triangle,
                              other - 0.5 * l0 * aside, foot - 0.5 * l0 * aside));
  }
}

TEST(FadingEdge, WaterGoesAroundTheKeelOfASharpEnd) {
  const BodySurface3d& body = hull_in_water();
  const Vector3d one(0.46, -0.115, 0.4 * l0), other(0.46, -0.115, -0.4 * l0);
  const int a = body.near(one, reach).triangle, b = body.near(other, reach).triangle;
  ASSERT_TRUE(body.separates(one, a, other, b));
  const double way = body.way_around(one, a, other, b);
  EXPECT_NEAR(way, 2 * std::hypot(0.005, 0.4 * l0), 1e-3) << "under the keel at y = -0.12";
  EXPECT_TRUE(body.beside_corner(one, reach));
}

// The keel turns by a right angle at |x| = 0.354. The faces beside it look sideways past one another there,
// so that their directions alone do not tell port from starboard.
TEST(FadingEdge, WaterBesideASharpKeelSeesNoLayerOfTheOtherSide) {
  const BodySurface3d& body = hull_in_water();
  int looked = 0;
  for (int k = 0; k < body.points(); ++k) {
    const Vector3d x = body.point(k);
    if (std::abs(x.x()) < 0.37 || std::abs(x.x()) > 0.43 || x.y() > -0.09) continue;
    for (const double along : {-0.5, 0.0, 0.5})
      for (const double height : {0.3, 0.8, 1.3}) {
        const double y = x.y() + along * l0;
        if (y < -0.115) continue;
        const double other = x.z() > 0 ? -1 : 1;
        const Vector3d water(x.x(), y, other * (half_breadth(x.x(), y) + height * l0));
        if ((water - x).dot(body.normal(k)) > 0) continue;
        const int near = body.near(water, reach).triangle;
        for (const double depth : {0.5, 1.5, 2.5}) {
          ++looked;
          EXPECT_FALSE(body.crosses(k, near, water, x - depth * l0 * body.normal(k)))
              << x.transpose() << " from " << water.transpose();
        }
      }
  }
  EXPECT_GT(looked, 100);
}

TEST(FadingEdge, BeforeAStemTheNearestTriangleIsThatOfThisSide) {
  const BodySurface3d& body = hull_in_water();
  for (double y = -0.1; y < 0; y += 0.0037)
    for (const double z : {1e-4, 1e-3, 4e-3})
      for (const int side : {1, -1}) {
        const Vector3d x(0.512, y, side * z);
        EXPECT_GT(side * body.face_normal(body.near(x, reach).triangle).z(), 0) << x.transpose();
      }
}

TEST(FadingEdge, HowFarWaterLiesInsideAKeelIsCountedAlongTheFace) {
  const BodySurface3d& body = hull_in_water();
  for (const int side : {1, -1}) {
    const double y = -0.11;
    const Vector3d foot(0.44, y, side * half_breadth(0.44, y));
    const int k = wet_point(body, foot);
    const double inside = std::hypot(draught + y, foot.z());
    EXPECT_NEAR(body.inside_keel(k, foot), inside, 0.1 * inside);
    EXPECT_LT(body.inside_keel(k, Vector3d(0.44, -0.13, 0)), 0) << "under the keel";
    EXPECT_GT(body.inside_keel(wet_point(body, {0, -0.06, side * 0.09}), Vector3d(0, -0.06, side * 0.1)), 1)
        << "no keel amidships";
  }
}

TEST(FadingEdge, AmidshipsTheKeelIsNoEdge) {
  const BodySurface3d& body = hull_in_water();
  const Vector3d below(0.02, -0.125, 0.003);
  EXPECT_FALSE(body.beside_corner(below, 0.1));
  for (const int side : {1, -1}) EXPECT_TRUE(body.faces(wet_point(body, {0.02, -0.11, 0.01 * side}), below));
}

}  // namespace fading_edge_test
}  // namespace strake::fluid
