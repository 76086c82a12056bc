#include "fluid/geometry/wet_points.hpp"

#include "fluid/geometry/body_surface_3d.hpp"
#include "structure/body/solid_surface.hpp"
#include "structure/body/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace wet_points_test {

using Eigen::Vector3d;

constexpr double l0 = 0.01, reach = 3.1 * l0;

// The middle of a piece of a bent face lies inside the bend, where the other face of a thin sheet is nearer.
TEST(WetPoints, OfAThinBentSheetLieOnTheirOwnFace) {
  const double radius = 4 * l0, thickness = 0.01 * l0;
  std::vector<Eigen::Vector2d> section;
  for (const bool outer : {true, false})
    for (int k = 0; k <= 60; ++k) {
      const double angle = (outer ? 180 + 3 * k : 360 - 3 * k) * std::numbers::pi / 180;
      section.push_back((outer ? radius : radius - thickness) *
                        Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  const InterfaceMesh mesh = structure::prism_surface(structure::outline(section, l0), 0.1, 0, l0);
  const BodySurface3d body(mesh, l0, reach);
  int outside = 0, inside = 0;
  for (int k = 0; k < body.points(); ++k) {
    const Vector3d x = body.point(k);
    const double away = std::hypot(x.x(), x.y()),
                 outwards = body.normal(k).dot(Vector3d(x.x(), x.y(), 0)) / away;
    if (std::abs(outwards) < 0.9) continue;
    ++(outwards > 0 ? outside : inside);
    for (int j = 0; j < k; ++j) {
      const Vector3d y = body.point(j);
      if (body.edge_of(j) != body.edge_of(k)) continue;
      EXPECT_GT(body.normal(j).dot(Vector3d(y.x(), y.y(), 0)) * outwards, 0);
    }
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(inside, 100);
}

TEST(TriangleGrid, ThereIsNoPlaceBeyondTheLimit) {
  const InterfaceMesh box =
      structure::prism_surface(structure::outline({{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}, l0), 0.1, 0, l0);
  TriangleGrid grid;
  const auto is_none = [&](const Vector3d& x) {
    const TriangleGrid::Foot foot = grid.nearest(x, l0);
    return foot.triangle < 0 && std::isinf(foot.distance);
  };
  EXPECT_TRUE(is_none({0, 0, 0}));  // empty
  grid.build(box.position, box.faces, l0);
  EXPECT_TRUE(is_none({0.05, 0.05, 0}));
  EXPECT_TRUE(is_none({0.05, 0.2, 0}));  // outside the bounding box
  EXPECT_FALSE(is_none({0.05, 0.109, 0}));
}

}  // namespace wet_points_test
}  // namespace strake::fluid
