#include "fluid/geometry/body_surface_2d.hpp"

#include "structure/body/surface.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace body_surface_2d_test {

using Places = std::vector<Eigen::Vector2d>;

constexpr double l0 = 0.01, R = 0.15;

/// The closed polygon of these corners, with points about `apart` from one another.
InterfaceMesh polygon(const Places& corner, double apart = l0) {
  return structure::outline(corner, apart);
}

/// Points of a circle about (0, R), from one angle to another in steps [degrees].
Places arc(double from, double to, double step) {
  Places out;
  for (int k = 0; from + k * step <= to + 1e-9; ++k) {
    const double angle = (from + k * step) / 180 * std::numbers::pi;
    out.emplace_back(R * std::cos(angle), R + R * std::sin(angle));
  }
  return out;
}

/// A round bottom with upright sides and a flat deck.
Places round_bottom() {
  Places out = arc(180, 360, 5);
  out.emplace_back(R, R + 0.1);
  out.emplace_back(-R, R + 0.1);
  return out;
}

/// A circle with a flat top; more than half of it is left.
Places cut_circle() {
  return arc(150, 390, 5);
}

/// A bow's section: faces of 16, 45, 59 and 45 degrees, upright at the deck.
Places bow() {
  const Places half = {{0, 0}, {0.06, 0.017}, {0.1, 0.057}, {0.13, 0.107}, {0.2, 0.177}, {0.2, 0.227}};
  Places out = half;
  for (std::size_t k = half.size() - 1; k > 0; --k) out.emplace_back(-half[k].x(), half[k].y());
  return out;
}

/// Whether water at that distance before the wet point, turned from its normal, sees it through its own edge.
bool is_seen(const BodySurface2d& outline, int point, double distance, double aside) {
  const Eigen::Vector2d n = outline.normal(point), along(-n.y(), n.x()),
                        behind = outline.point(point) - 0.5 * l0 * n,
                        from = outline.point(point) + distance * n + aside * along;
  return outline.crosses(point, from, behind);
}

// The pieces of a bent edge do not follow one another along its chord.
TEST(BodySurface2d, WaterSeesEveryPieceOfABentEdge) {
  for (const Places& body : {round_bottom(), bow(), arc(0, 355, 5)}) {
    const BodySurface2d outline(polygon(body), l0);
    for (int k = 0; k < outline.points(); ++k)
      for (const double aside : {-0.5, 0.0, 0.5})
        EXPECT_TRUE(is_seen(outline, k, 0.5 * l0, aside * l0)) << k << " " << outline.point(k).transpose();
  }
}

// The direction from an end of an edge tells nothing of its far side, where a bent edge has turned back.
TEST(BodySurface2d, WaterBeforeAPieceLiesOverItsFace) {
  for (const Places& body :
       {round_bottom(), cut_circle(), bow(), arc(0, 355, 5), Places{{0, 0}, {0.2, 0.1}, {-0.2, 0.1}}}) {
    const BodySurface2d outline(polygon(body), l0);
    for (int k = 0; k < outline.points(); ++k)
      EXPECT_GE(outline.within(outline.edge_of(k), outline.point(k) + 0.5 * l0 * outline.normal(k)), 0)
          << outline.point(k).transpose();
  }
}

TEST(BodySurface2d, WaterOnOneSideOfAThinRoundBodySeesNoLayerOfTheOther) {
  Places body;  // three spacings thick, its ends are half rounds of sides of 36 degrees
  const double r = 1.5 * l0;
  for (int k = 0; k < 12; ++k) {
    const double angle = (k < 6 ? 180 + 36 * k : 36 * (k - 6)) / 180.0 * std::numbers::pi;
    body.emplace_back(r * std::cos(angle), (k < 6 ? -0.1 : 0.1) + r * std::sin(angle));
  }
  const BodySurface2d outline(polygon(body), l0);
  ASSERT_EQ(outline.edges().size(), 1u);
  int seen = 0;
  for (int k = 0; k < outline.points(); ++k) {
    if (std::abs(outline.point(k).y()) > 0.08) continue;
    const Eigen::Vector2d n = outline.normal(k), behind = outline.point(k) - 1.5 * l0 * n,
                          other_side = outline.point(k) - (2 * r + 0.5 * l0) * n;
    seen += outline.crosses(k, outline.point(k) + 0.5 * l0 * n, behind) ? 1 : 0;
    EXPECT_FALSE(outline.crosses(k, other_side, behind)) << outline.point(k).transpose();
  }
  EXPECT_GT(seen, 20);
}

TEST(BodySurface2d, AKnuckleDividesStretchesAndStaysInItsPlace) {
  const BodySurface2d outline(polygon(bow()), l0, {.sharpest = 0.7});
  ASSERT_EQ(outline.edges().size(), 5u);  // from the keel to each chine of 45 degrees, the sides, the deck
  const BodySurface2d::Edge& bottom = outline.edges()[0];
  ASSERT_EQ(bottom.stretch.size(), 3u);  // the two turns of 14 degrees count as a smooth bend
  for (std::size_t c : {0, 1})
    EXPECT_NEAR((outline.vertex(bottom.vertex + bottom.stretch[c]) - bow()[c]).norm(), 0, 1e-12);
}

/// A flat bottom 0.3 m wide with sides of 60 degrees, or a V with upright sides, heeled by that angle.
Places heeled(Places corner, double degrees) {
  const Eigen::Rotation2Dd turn(degrees / 180 * std::numbers::pi);
  for (auto& x : corner) x = turn * x;
  return corner;
}
const Places flared = {{0.15, 0}, {0.2193, 0.12}, {-0.2193, 0.12}, {-0.15, 0}};
const Places vee = {{0, 0}, {0.15, 0.0546}, {0.15, 0.1746}, {-0.15, 0.1746}, {-0.15, 0.0546}};

TEST(BodySurface2d, AFlatBottomIsOneFaceWithTheFlaredSidesBesideIt) {
  for (const double heel : {0.0, 4.0, -10.0}) {
    const Places corner = heeled(flared, heel);
    const BodySurface2d outline(polygon(corner), l0);
    ASSERT_EQ(outline.edges().size(), 2u) << heel;  // the deck is the other
    const Eigen::Vector2d inwards = (corner[3] - corner[0]).normalized(),
                          upwards = (corner[1] - corner[0]).normalized();
    int of_bottom = 0;
    for (int k = 0; k < outline.points(); ++k) {
      const Eigen::Vector2d from = outline.point(k) - corner[0];
      if (from.norm() > 4 * l0) continue;
      const bool is_bottom = from.dot(inwards) > from.dot(upwards);
      const Eigen::Vector2d mine = is_bottom ? inwards : upwards, theirs = is_bottom ? upwards : inwards;
      of_bottom += is_bottom ? 1 : 0;
      // On the plane that halves the chine, one and a half spacings along either face.
      EXPECT_NEAR(outline.inside_chine(k, corner[0] - l0 * (mine + theirs)), 0, 1e-12);
      EXPECT_NEAR(outline.inside_chine(k, corner[0] + 1.5 * l0 * mine), 1.5 * l0, 1e-12);
      EXPECT_NEAR(outline.inside_chine(k, corner[0] + 1.5 * l0 * theirs), -1.5 * l0, 1e-12);
    }
    EXPECT_EQ(of_bottom, 4);
  }
}

TEST(BodySurface2d, ChinesTurnWithTheBody) {
  BodySurface2d outline(polygon(flared), l0);
  const Eigen::Rotation2Dd turn(0.7);
  BodySurface2d::Vectors2 displacement(2, outline.points());
  for (int k = 0; k < outline.points(); ++k)
    displacement.col(k) = turn * outline.reference(k).head<2>() - outline.reference(k).head<2>();
  outline.move(displacement, BodySurface2d::Vectors2::Zero(2, outline.points()));
  const Eigen::Vector2d under = turn * (flared[0] - Eigen::Vector2d(0.5 * l0, 0));
  int near = 0;
  for (int k = 0; k < outline.points(); ++k) {
    const double inside = outline.inside_chine(k, under);
    if (std::isinf(inside)) continue;
    EXPECT_NEAR(std::abs(inside), 0.5 * l0, 1e-12);
    ++near;
  }
  EXPECT_GT(near, 30);  // the bottom and one side
}

// Where a V heels water crosses its keel. As a corner it would end both faces there.
TEST(BodySurface2d, AKeelThatLeansByMoreThanTwoDegreesIsAKnuckle) {
  for (const double heel : {0.0, 1.5})
    EXPECT_EQ(BodySurface2d(polygon(heeled(vee, heel)), l0).edges().size(), 5u) << heel;
  for (const double heel : {2.5, -12.0, 8.0})
    EXPECT_EQ(BodySurface2d(polygon(heeled(vee, heel)), l0).edges().size(), 4u) << heel;
}

TEST(BodySurface2d, AConcaveTurnOfTwoFacesThatLookDownIsACorner) {
  const Places gull = {{-0.1, 0}, {0, 0.06}, {0.1, 0}, {0.2, 0.2}, {-0.2, 0.2}};
  const BodySurface2d outline(polygon(gull), l0);
  for (int k = 0; k < outline.points(); ++k)
    EXPECT_GT(outline.inside_chine(k, gull[1] - Eigen::Vector2d(0, l0)), 4 * l0);
}

TEST(BodySurface2d, PointsOnTheStraightFacesOfAPolygonMakeNoCorners) {
  for (const double apart : {0.02, 0.01, 0.004, 0.001}) {
    const BodySurface2d outline(polygon(round_bottom(), apart), l0);
    ASSERT_EQ(outline.edges().size(), 2u) << apart;
    EXPECT_TRUE(outline.is_curved(0) != outline.is_curved(1)) << apart;
  }
}

TEST(BodySurface2d, OnlyFacesThatHardlyTurnCountAsThoseOfPlates) {
  const BodySurface2d round(polygon(round_bottom()), l0);
  for (const int edge : {0, 1})
    EXPECT_EQ(round.is_between_sharp_corners(edge), !round.is_curved(edge)) << edge;  // the deck alone
  const BodySurface2d plate(polygon({{-0.2, 0}, {0.2, 0}, {0.2, 0.03}, {-0.2, 0.03}}), l0);
  for (int edge = 0; edge < 4; ++edge) EXPECT_TRUE(plate.is_between_sharp_corners(edge));
}

TEST(BodySurface2d, AClosedOutlineOfKnucklesAloneKeepsThem) {
  const Places corner = arc(15, 345, 30);  // twelve turns of 30 degrees, two level faces
  const BodySurface2d outline(polygon(corner), l0);
  ASSERT_EQ(outline.edges().size(), 1u);
  const BodySurface2d::Edge& edge = outline.edges()[0];
  EXPECT_TRUE(edge.closed);
  ASSERT_EQ(edge.stretch.size(), 13u);
  for (const Eigen::Vector2d& place : corner) {
    double nearest = R;
    for (const int i : edge.stretch)
      nearest = std::min(nearest, (outline.vertex(edge.vertex + i) - place).norm());
    EXPECT_NEAR(nearest, 0, 1e-12);
  }
}

// A mesh of any program may be finer than the water: bilges rounded by a tenth of a spacing, rounded numbers.
TEST(BodySurface2d, DetailsFinerThanTheWaterMakeNoEdgesAndNoStretches) {
  Places box;
  for (const auto& [x, from] : {std::pair(0.099, 270), std::pair(-0.099, 180)})
    for (int k = 0; k <= 9; ++k) {
      const double angle = (from + 10 * k) * std::numbers::pi / 180;
      box.emplace_back(x + 0.001 * std::cos(angle), 0.001 + 0.001 * std::sin(angle));
      if (from == 270 && k == 9) box.insert(box.end(), {{0.1, 0.1}, {-0.1, 0.1}});
    }
  const BodySurface2d sharp(polygon(box), l0);
  ASSERT_EQ(sharp.edges().size(), 4u);
  for (int edge = 0; edge < 4; ++edge) EXPECT_TRUE(sharp.is_between_sharp_corners(edge));
  Places stairs;  // a round bottom in steps of a millimetre
  for (const Eigen::Vector2d& x : arc(180, 360, 0.5)) {
    const Eigen::Vector2d rounded(1e-3 * std::round(1e3 * x.x()), 1e-3 * std::round(1e3 * x.y()));
    if (stairs.empty() || stairs.back() != rounded) stairs.push_back(rounded);
  }
  stairs.insert(stairs.end(), {{R, R + 0.1}, {-R, R + 0.1}});
  const BodySurface2d round(polygon(stairs), l0);
  EXPECT_EQ(round.edges().size(), 2u);
  for (const BodySurface2d::Edge& edge : round.edges()) EXPECT_LT(edge.stretch.size(), 6u);  // lone turns
}

// Every piece is an edge or a stretch of its own.
TEST(BodySurface2d, CornersBetweenEdgesOfOnePieceTurnWithTheBody) {
  for (const Places& body :
       {Places{{0, 0}, {0.01, 0.002}, {0.012, 0.012}, {-0.001, 0.01}}, arc(15, 345, 30),
        Places{{0, 0}, {0.009, 0.006}, {0.006, 0.014}, {-0.006, 0.014}, {-0.009, 0.006}}}) {
    BodySurface2d outline(polygon(body, 0.1), body.size() > 6 ? 0.08 : l0);
    ASSERT_EQ(outline.points(), std::ssize(body));
    const auto vertices = outline.points() + static_cast<int>(outline.edges().size());
    Places before;
    for (int v = 0; v < vertices; ++v) before.push_back(outline.vertex(v));
    const Eigen::Matrix2Xd X = outline.mesh().position.topRows<2>();
    const Eigen::Matrix2d turn = Eigen::Rotation2D<double>(0.8).toRotationMatrix();
    const Eigen::Matrix2Xd x = (turn * X).colwise() + Eigen::Vector2d(0.3, -0.2);
    const double rate = 5;
    Eigen::Matrix2Xd velocity(2, X.cols());
    velocity << -rate * x.row(1), rate * x.row(0);
    outline.move(x - X, velocity);
    for (int v = 0; v < vertices; ++v) {
      const Eigen::Vector2d at = outline.vertex(v);
      EXPECT_LT((at - turn * before[static_cast<std::size_t>(v)] - Eigen::Vector2d(0.3, -0.2)).norm(), 1e-12);
      EXPECT_LT((outline.vertex_velocity(v) - rate * Eigen::Vector2d(-at.y(), at.x())).norm(), 1e-11);
    }
  }
}

}  // namespace body_surface_2d_test
}  // namespace strake::fluid
