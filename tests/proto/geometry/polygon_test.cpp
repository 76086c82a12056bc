#include "proto/geometry/polygon.hpp"

#include "proto/geometry/corner.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace strake {
namespace polygon_test {

// An L: the unit square without its upper right quarter.
const Polygon l_shape = {{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}};

TEST(Polygon, knows_its_inside_area_and_distance) {
  EXPECT_TRUE(inside_polygon(l_shape, {0.25, 0.75}));
  EXPECT_FALSE(inside_polygon(l_shape, {0.75, 0.75}));
  EXPECT_FALSE(inside_polygon(l_shape, {-0.1, 0.5}));
  EXPECT_NEAR(polygon_area(l_shape), 0.75, 1e-15);
  EXPECT_NEAR(polygon_area({l_shape.rbegin(), l_shape.rend()}), -0.75, 1e-15);
  EXPECT_NEAR(distance_to_polygon(l_shape, {0.75, 0.75}), 0.25, 1e-15);
}

TEST(Polygon, a_ray_through_corners_counts_each_edge_from_its_lower_end) {
  EXPECT_TRUE(inside_polygon(l_shape, {0.25, 0.5}));   // through (0.5, 0.5) and (1, 0.5)
  EXPECT_FALSE(inside_polygon(l_shape, {-0.5, 0.5}));  // and through the left side
  EXPECT_FALSE(inside_polygon(l_shape, {-0.5, 1}));    // along the upper edge
  EXPECT_TRUE(inside_polygon(l_shape, {0.25, 0}));     // on the lower edge: inside
  EXPECT_FALSE(inside_polygon(l_shape, {0.25, 1}));    // on the upper edge: outside
}

TEST(Polygon, turns_are_positive_counter_clockwise) {
  EXPECT_NEAR(turn({1, 0}, {0, 2}), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(turn({1, 0}, {1, -1}), -std::numbers::pi / 4, 1e-15);
}

TEST(Bend, a_small_turn_stands_out_only_where_it_is_alone) {
  EXPECT_TRUE(stands_out(0.4, 0.4));
  EXPECT_FALSE(stands_out(0.3, 0.2));
  EXPECT_TRUE(stands_out(0.3, 0.05));
  EXPECT_FALSE(stands_out(0.02, 0));
}

/// Unit normal that points down, turned by that angle to the right.
Eigen::Vector2d down(double degrees) {
  const double angle = degrees / 180 * std::numbers::pi;
  return {std::sin(angle), -std::cos(angle)};
}

TEST(Bend, two_faces_of_a_hull_meet_in_a_knuckle_or_a_chine) {
  const auto bend = [](double first, double second) {
    return bend_of(std::abs(second - first) / 180 * std::numbers::pi, 0.0, down(first), down(second));
  };
  EXPECT_EQ(bend(16, 45), Bend::knuckle);
  EXPECT_EQ(bend(45, 16), Bend::knuckle);  // flare
  EXPECT_EQ(bend(0, 10), Bend::knuckle);
  EXPECT_EQ(bend(20, 90), Bend::corner);   // chine
  EXPECT_EQ(bend(-10, 10), Bend::corner);  // keel
  EXPECT_EQ(bend(80, 110), Bend::knuckle);
  EXPECT_EQ(bend(10, 11), Bend::smooth);
  EXPECT_EQ(bend(0, 45), Bend::knuckle);  // chamfer
  EXPECT_EQ(bend_of(1.2, 0.0, down(20), down(89), knuckles_under_water), Bend::knuckle);
}

}  // namespace polygon_test
}  // namespace strake
