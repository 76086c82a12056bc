#include "proto/geometry/thinning.hpp"

#include "proto/geometry/corner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace strake {
namespace thinning_test {

constexpr double l0 = 0.01, degree = std::numbers::pi / 180;

/// Points of an arc in steps of about `step` [degrees], both ends among them.
void add_arc(Polygon& p, const Eigen::Vector2d& centre, double radius, double from, double to, double step) {
  const int n = std::max(1, static_cast<int>(std::lround((to - from) / step)));
  for (int k = 0; k <= n; ++k) {
    const double angle = degree * (from + k * (to - from) / n);
    p.emplace_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
}

Polygon half_circle(double radius, double step) {
  Polygon p;
  add_arc(p, {0, radius}, radius, 180, 360, step);
  p.emplace_back(radius, radius + 0.1);
  p.emplace_back(-radius, radius + 0.1);
  return p;
}

Polygon box(double width, double height, double rounding, double step) {
  const double x = 0.5 * width - rounding, y = height - rounding;
  Polygon p;
  add_arc(p, {x, rounding}, rounding, 270, 360, step);
  add_arc(p, {x, y}, rounding, 0, 90, step);
  add_arc(p, {-x, y}, rounding, 90, 180, step);
  add_arc(p, {-x, rounding}, rounding, 180, 270, step);
  return p;
}

double shortest_side(const Polygon& p) {
  double shortest = 1;
  for (std::size_t k = 0; k < p.size(); ++k) shortest = std::min(shortest, (following(p, k) - p[k]).norm());
  return shortest;
}

double largest_turn(const Polygon& p) {
  double largest = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Eigen::Vector2d before = p[k] - p[(k + p.size() - 1) % p.size()];
    largest = std::max(largest, std::abs(turn(before, following(p, k) - p[k])));
  }
  return largest;
}

double farthest(const Polygon& p, const Polygon& from) {
  double distance = 0;
  for (const Eigen::Vector2d& x : p) distance = std::max(distance, distance_to_polygon(from, x));
  return distance;
}

bool is_symmetric(const Polygon& p) {
  return std::ranges::all_of(p, [&](const Eigen::Vector2d& x) {
    return std::ranges::any_of(p, [&](const Eigen::Vector2d& y) {
      return std::abs(x.x() + y.x()) < 1e-12 && std::abs(x.y() - y.y()) < 1e-12;
    });
  });
}

TEST(Thinning, AnOutlineOfLongSidesStaysAsItIs) {
  for (const Polygon& p : {half_circle(0.15, 5), box(0.3, 0.2, 0.02, 15)}) {
    EXPECT_EQ(thinned(p, l0), p);
    EXPECT_EQ(without_details(p, l0), p);
  }
}

TEST(Thinning, OffsetsFinerThanTheWaterAreThinnedAndStayInTheirPlace) {
  for (const double radius : {0.05, 0.15, 1.0})
    for (const double step : {0.1, 0.5, 1.0}) {
      const Polygon fine = half_circle(radius, step), p = thinned(fine, l0);
      if (shortest_side(fine) >= 0.5 * l0) continue;
      EXPECT_LT(p.size(), fine.size() / 2);
      EXPECT_GT(shortest_side(p), 0.3 * l0);
      EXPECT_LE(farthest(fine, p), 0.01 * l0 * (1 + 1e-9));
      EXPECT_EQ(without_details(fine, l0), fine);  // smooth
      EXPECT_TRUE(is_symmetric(p)) << radius << ' ' << step;
    }
}

TEST(Thinning, ASmallRoundingOrChamferIsACorner) {
  for (const double rounding : {0.05, 0.1, 0.3})
    for (const double step : {5.0, 30.0, 90.0}) {
      if (step > 80 && rounding > 0.2) continue;
      for (const Polygon& p : {thinned(box(0.3, 0.2, rounding * l0, step), l0),
                               without_details(box(0.3, 0.2, rounding * l0, step), l0)}) {
        ASSERT_EQ(p.size(), 4u) << rounding << ' ' << step;
        EXPECT_LT((p[0] - Eigen::Vector2d(0.15, 0)).norm(), 1e-12);
        EXPECT_LT((p[2] - Eigen::Vector2d(-0.15, 0.2)).norm(), 1e-12);
      }
    }
  EXPECT_GT(thinned(box(0.3, 0.2, 0.6 * l0, 5), l0).size(), 8u);  // the water sees it
}

TEST(Thinning, RoundedNumbersMakeNoCorners) {
  Polygon p;
  for (const Eigen::Vector2d& x : half_circle(0.15, 0.5)) {
    const Eigen::Vector2d rounded(1e-3 * std::round(1e3 * x.x()), 1e-3 * std::round(1e3 * x.y()));
    if (p.empty() || rounded != p.back()) p.push_back(rounded);
  }
  ASSERT_GT(largest_turn(Polygon(p.begin(), p.end() - 3)), 0.7);  // stairs of a millimetre
  for (const Polygon& q : {thinned(p, l0), without_details(p, l0)}) {
    EXPECT_LT(farthest(p, q), 0.12 * l0);
    EXPECT_TRUE(is_symmetric(q));
    const double top = 0.15 - 1e-9;  // without the upright sides
    Polygon round;
    for (const Eigen::Vector2d& x : q)
      if (x.y() < top) round.push_back(x);
    double largest = 0;
    for (std::size_t k = 1; k + 1 < round.size(); ++k)
      largest = std::max(largest, std::abs(turn(round[k] - round[k - 1], round[k + 1] - round[k])));
    EXPECT_LT(largest, corner_angle);
  }
}

TEST(Thinning, ThinPlatesAndStepsStay) {
  const Polygon plate = {{0, 0}, {0.2, 0}, {0.2, 0.3 * l0}, {0, 0.3 * l0}};
  Polygon tilted;
  for (const Eigen::Vector2d& x : plate)
    tilted.emplace_back(0.8 * x.x() - 0.6 * x.y(), 0.6 * x.x() + 0.8 * x.y());
  const Polygon step = {{0, 0}, {0.1, 0}, {0.1, 0.3 * l0}, {0.2, 0.3 * l0}, {0.2, 0.1}, {0, 0.1}};
  for (const Polygon& p : {plate, tilted, step}) {
    EXPECT_EQ(thinned(p, l0), p);
    EXPECT_EQ(without_details(p, l0), p);
  }
  const Polygon sheet = {{0, 0}, {0.2, 0.1}, {0.2, 0.1 + 1e-5}, {0, 1e-5}};
  EXPECT_EQ(thinned(sheet, l0), sheet);  // nothing would be left
}

}  // namespace thinning_test
}  // namespace strake
