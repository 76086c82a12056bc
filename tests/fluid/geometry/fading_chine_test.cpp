// The chine of a planing hull that enters the water: an edge that ends in a smooth surface at the bow.

#include "fluid/geometry/body_surface_3d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace fading_chine_test {

using Eigen::Vector3d;

constexpr double l0 = 0.025, reach = 3.1 * l0, half = 0.15, deck = 0.2, length = 0.6;
constexpr int stations = 24;
const double slope = std::tan(std::numbers::pi / 9);  // 20 degrees
/// Normal of the starboard bottom aft.
const Vector3d bottom = Vector3d(0, -1, slope).normalized();

/// Keel, chine and deck of the starboard half: prismatic aft, at the bow narrower and steeper.
std::vector<Vector3d> section(int i) {
  const double x = length * i / stations - 0.5 * length, fore = std::max(0.0, 2 * x / length);
  const double breadth = half * (1 - 0.85 * fore * fore), keel = 0.02 * fore * fore,
               chine = keel + breadth * std::tan((1 + 2 * fore) * std::numbers::pi / 9);
  return {{x, keel, 0}, {x, chine, breadth}, {x, deck, breadth}};
}

/// The chine turns by 70 degrees aft and by less than 46 at the bow: bottom and side are one patch.
InterfaceMesh hull() {
  std::vector<Vector3d> corner;
  const auto port = [](const Vector3d& c) { return Vector3d(c.x(), c.y(), -c.z()); };
  const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    for (const Vector3d& x : {a, b, c}) corner.push_back(x);
  };
  const auto add_both = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    add(a, b, c);
    add(port(a), port(c), port(b));
  };
  for (int i = 0; i < stations; ++i) {
    const auto a = section(i), b = section(i + 1);
    for (std::size_t k = 0; k < 2; ++k) {
      add_both(a[k], b[k], b[k + 1]);
      add_both(a[k], b[k + 1], a[k + 1]);
    }
    add(a[2], b[2], port(b[2]));
    add(a[2], port(b[2]), port(a[2]));
  }
  const auto aft = section(0), fore = section(stations);
  add(aft[0], aft[1], port(aft[1]));
  add(aft[1], aft[2], port(aft[2]));
  add(aft[1], port(aft[2]), port(aft[1]));
  add(fore[0], port(fore[1]), fore[1]);
  add(fore[1], port(fore[2]), fore[2]);
  add(fore[1], port(fore[1]), port(fore[2]));
  InterfaceMesh mesh{.name = "hull", .position = {}, .faces = {}, .mass = {}};
  std::vector<Vector3d> place;
  mesh.faces.resize(3, static_cast<Eigen::Index>(corner.size() / 3));
  for (std::size_t k = 0; k < corner.size(); ++k) {
    auto known =
        std::ranges::find_if(place, [&](const Vector3d& x) { return (x - corner[k]).norm() < 1e-9; });
    if (known == place.end()) known = place.insert(place.end(), corner[k]);
    mesh.faces.data()[k] = static_cast<int>(known - place.begin());
  }
  mesh.position.resize(3, static_cast<Eigen::Index>(place.size()));
  for (std::size_t k = 0; k < place.size(); ++k) mesh.position.col(static_cast<Eigen::Index>(k)) = place[k];
  return mesh;
}

const BodySurface3d& hull_that_enters() {
  static const BodySurface3d body(hull(), l0, reach);
  return body;
}

/// A place before the chine amidships: `in` from it along the bottom, `up` along the side, `off` the face
/// [l0].
Vector3d under_bottom(double in, double off) {
  return Vector3d(-0.1, half * slope, half) - in * l0 * Vector3d(0, slope, 1).normalized() +
         off * l0 * bottom;
}
Vector3d beside_side(double up, double off) {
  return {-0.1, half * slope + up * l0, half + off * l0};
}

TEST(FadingChine, BottomAndSideHaveTheirOwnWetPointsAndNormals) {
  const BodySurface3d& body = hull_that_enters();
  int of_bottom = 0, of_side = 0;
  double area = 0;
  for (int k = 0; k < body.points(); ++k) {
    const Vector3d x = body.point(k), n = body.normal(k);
    if (x.x() < -0.27 || x.x() > -0.05 || x.z() < 0 || n.y() > 0.9) continue;  // prismatic, no deck
    const bool is_bottom = n.dot(bottom) > 0.999;
    EXPECT_TRUE(is_bottom || n.z() > 0.999) << x.transpose() << ": " << n.transpose();
    EXPECT_GT(n.dot(body.area_vector(k).normalized()), 0.999) << x.transpose();
    ++(is_bottom ? of_bottom : of_side);
    area += body.area(k);
  }
  EXPECT_GT(of_bottom, 40);
  EXPECT_GT(of_side, 35);
  EXPECT_NEAR(area, 0.22 * (half / std::cos(std::numbers::pi / 9) + deck - half * slope), 0.004);
}

TEST(FadingChine, WaterUnderTheBottomSeesNoLayerOfTheSide) {
  const BodySurface3d& body = hull_that_enters();
  int looked = 0;
  for (int k = 0; k < body.points(); ++k) {
    const Vector3d at = body.point(k);
    if (std::abs(at.x() + 0.1) > l0 || at.z() < 0 || body.normal(k).z() < 0.9) continue;
    for (const double in : {0.3, 1.0, 2.0})
      for (const double depth : {0.5, 1.5, 2.5}) {
        const Vector3d water = under_bottom(in, 0.5), layer = at - depth * l0 * body.normal(k);
        if ((water - layer).norm() > reach) continue;
        EXPECT_FALSE(body.crosses(k, body.near(water, reach).triangle, water, layer)) << in << ", " << depth;
        ++looked;
      }
  }
  EXPECT_GT(looked, 30);
}

TEST(FadingChine, AFaceEndsAtTheChine) {
  const BodySurface3d& body = hull_that_enters();
  int k = -1;
  for (int j = 0; j < body.points(); ++j)
    if (body.normal(j).dot(bottom) > 0.99 && (k < 0 || (body.point(j) - under_bottom(0.5, 0)).norm() <
                                                           (body.point(k) - under_bottom(0.5, 0)).norm()))
      k = j;
  EXPECT_NEAR(body.within(k, under_bottom(0.5, 0.3)), 0.5 * l0, 1e-6);
  EXPECT_NEAR(body.within(k, under_bottom(-0.5, 0.3)), -0.5 * l0, 1e-6);
  EXPECT_TRUE(body.faces(k, under_bottom(-0.3, 0.5))) << "before the plane that halves the chine";
  EXPECT_FALSE(body.faces(k, beside_side(0.5, 0.5)));
}

TEST(FadingChine, WaterGoesAroundTheChine) {
  const BodySurface3d& body = hull_that_enters();
  const Vector3d a = under_bottom(0.6, 0.2), b = beside_side(0.6, 0.2), c = under_bottom(1.2, 0.2);
  const int near_a = body.near(a, reach).triangle, near_b = body.near(b, reach).triangle,
            near_c = body.near(c, reach).triangle;
  ASSERT_TRUE(body.separates(a, near_a, b, near_b));
  const Vector3d chine = under_bottom(0, 0);
  EXPECT_NEAR(body.way_around(a, near_a, b, near_b), (a - chine).norm() + (b - chine).norm(), 1e-9);
  EXPECT_TRUE(body.beside_corner(a, reach));
  EXPECT_FALSE(body.separates(a, near_a, c, near_c));
}

TEST(FadingChine, AtTheBowTheChineIsNoEdge) {
  const BodySurface3d& body = hull_that_enters();
  const auto before = section(stations - 2), behind = section(stations - 1);
  const Vector3d chine = 0.5 * (before[1] + behind[1]);
  const Vector3d a = chine + Vector3d(0.2, -0.5, 0.1) * l0, b = chine + Vector3d(0.2, 0.5, 0.4) * l0;
  EXPECT_FALSE(body.separates(a, body.near(a, reach).triangle, b, body.near(b, reach).triangle));
}

}  // namespace fading_chine_test
}  // namespace strake::fluid
