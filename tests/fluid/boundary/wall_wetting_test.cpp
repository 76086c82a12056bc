#include "fluid/boundary/wall_wetting.hpp"

#include "fluid/scheme/step_data.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace strake::fluid {
namespace wall_wetting_test {

constexpr double l0 = 0.01, width = 0.04;

/// A tank `width` across z.
Parameters channel() {
  Parameters p = basin(0.2, 0.06, l0, 0.08);
  for (auto* box : {&p.tank, &p.water}) {
    box->min[2] = 0;
    box->max[2] = width;
  }
  p.scheme = {};
  p.scheme.gradient = Gradient::least_squares;
  p.sound_speed = 1500;
  return p;
}

/// A prism of 45 degrees from side wall to side wall, its keel at the height `keel`.
InterfaceMesh keel_between_walls(double keel) {
  const InterfaceMesh outline =
      structure::outline({{0, keel}, {0.05, keel + 0.05}, {-0.05, keel + 0.05}}, l0);
  return structure::prism_surface(outline, width, 0.5 * width, l0);
}

// A keel of 45 degrees covers h² of a wall, h its depth. That grows evenly, though the faces meet the places
// of a whole diagonal of the wall's lattice at once.
TEST(WallContact, ABodyThatTouchesAWallCoversItGradually) {
  const Parameters p = channel();
  const InterfaceMesh body = keel_between_walls(0.003);
  Points down = Points::Zero(3, body.position.cols());
  StepData<3> step(p, body, down, PairData::inverses, {});
  WallContact<3> walls(step.boundary, step.state, l0);
  double before = 1.75 * 1.75;
  for (double depth = 1.8 * l0; depth < 2.22 * l0; depth += 0.05 * l0) {
    down.row(1).setConstant(-0.003 - depth);
    step.boundary.move(step.state, down, Points::Zero(3, down.cols()), true);
    step.search_neighbours();
    walls.update(step.boundary, step.state, step.near_gradient());
    double covered = 0;
    for (std::int64_t j = step.boundary.water(); j < step.boundary.first_of_bodies(); ++j)
      if (step.boundary.master_of(j) < 0 && walls.normal(j).z() > 0.5 && step.state.position(1, j) < 0)
        covered += walls.wet(j) ? 1 - walls.bare(j) : 1;
    const double exact = depth * depth / (l0 * l0);  // two triangles
    EXPECT_NEAR(covered, exact, 0.3) << depth / l0;
    EXPECT_LT(covered - before, 0.5) << depth / l0;  // 2 h dh = 0.25
    before = covered;
  }
}

TEST(WallContact, AFaceOfABodyThatStoodInTheWaterComesAndGoesGradually) {
  const Parameters p = channel();
  const InterfaceMesh body = keel_between_walls(0.003);
  Points place = Points::Zero(3, body.position.cols());
  StepData<3> step(p, body, place, PairData::inverses, {});
  constexpr double speed = 0.25;  // 4 v/l0 = 100/s
  WallContact<3> walls(step.boundary, step.state, l0, speed);
  const auto part_after = [&](double rise, double time) {
    place.row(1).setConstant(rise);
    step.boundary.move(step.state, place, Points::Zero(3, place.cols()), true);
    step.search_neighbours();
    walls.update(step.boundary, step.state, step.near_gradient(), time);
    const std::int64_t j = step.boundary.first_of_bodies();  // a face at the keel
    return walls.wet(j) ? walls.bare(j) : 0.0;
  };
  const std::int64_t keel = step.boundary.first_of_bodies();
  const auto is_dry = [&] { return step.state.surface[static_cast<std::size_t>(keel)] != 0; };
  EXPECT_EQ(part_after(0, 0), 0);
  EXPECT_NEAR(part_after(-0.03, 0.003), 0.3, 1e-12);  // under water
  EXPECT_NEAR(part_after(-0.03, 0.005), 0.8, 1e-12);
  EXPECT_FALSE(is_dry());
  EXPECT_NEAR(part_after(0.03, 0.002), 0.6, 1e-12);  // out of it
  EXPECT_TRUE(is_dry());
  WallContact<3> resumed(step.boundary, step.state, l0, speed);
  resumed.update(step.boundary, step.state, step.near_gradient(), 0.001);
  EXPECT_NEAR(resumed.bare(keel), 0.5, 1e-12);
  EXPECT_EQ(part_after(0.03, 0.02), 0);
}

// Water that has passed a corner and flies away from the face beyond does not meet it. Water that slides
// along the face, or comes back to it, does.
TEST(WallContact, WaterThatLeavesABodyDoesNotMeetItsFace) {
  const Parameters p = channel();
  const InterfaceMesh body = keel_between_walls(0.003);
  Points down = Points::Zero(3, body.position.cols()), velocity = down;
  down.row(1).setConstant(-0.02);
  velocity.row(1).setConstant(-5);
  StepData<3> step(p, body, down, PairData::inverses, {});
  const auto wet_faces = [&](double along, double away, bool is_beside_keel) {
    step.boundary.move(step.state, down, velocity, true);
    step.search_neighbours();
    WallContact<3> walls(step.boundary, step.state, l0);
    for (std::int64_t j = step.boundary.first_of_bodies(); j < step.state.position.cols(); ++j)
      step.state.surface[static_cast<std::size_t>(j)] = 1;
    const Eigen::Vector3d slope = Eigen::Vector3d(1, 1, 0).normalized(), normal(slope.y(), -slope.x(), 0);
    for (std::int64_t i = 0; i < step.boundary.water(); ++i)
      step.state.velocity.col(i) = Eigen::Vector3d(0, -5, 0) + along * slope + away * normal;
    walls.update(step.boundary, step.state, step.near_gradient());
    int wet = 0;  // faces on the starboard side, beside the keel or far from it
    for (std::int64_t j = step.boundary.first_of_bodies(); j < step.state.position.cols(); ++j)
      if (step.boundary.master_of(j) < 0 && walls.normal(j).x() > 0 &&
          (step.state.position(1, j) < -0.008) == is_beside_keel)
        wet += walls.wet(j) ? 1 : 0;
    return wet;
  };
  const int beside = wet_faces(0, 0, true), far = wet_faces(0, 0, false);
  EXPECT_GT(beside, 0);
  EXPECT_GT(far, 0);
  EXPECT_EQ(wet_faces(5, -1, true), beside);
  EXPECT_EQ(wet_faces(5, 1, true), beside);  // at 11 degrees
  EXPECT_EQ(wet_faces(5, 3, true), 0);
  EXPECT_EQ(wet_faces(5, 3, false), far);
}

// Where two walls meet, all of r counts but its part along their edge.
TEST(WallContact, EdgesOfATankThatRollsTurnWithIt) {
  Parameters p = channel();
  p.motion.roll = 0.5;
  p.motion.frequency = 1;
  p.end_time = 1;
  StepData<3> step(p, {}, {}, PairData::inverses, {});
  WallContact<3> walls(step.boundary, step.state, l0);
  const Eigen::Matrix3Xd start = step.state.position;
  const double quarter = 0.25;
  step.boundary.move_tank(step.state, quarter, false);
  step.boundary.move_tank(step.state, quarter, true);
  step.state.time = quarter;
  step.search_neighbours();
  walls.update(step.boundary, step.state, step.near_gradient());
  const WallContact<3> resumed(step.boundary, step.state, l0);
  const Eigen::Vector3d along(std::cos(0.5), std::sin(0.5), 0);
  int edges = 0;
  for (std::int64_t j = step.boundary.water(); j < step.boundary.first_of_bodies(); ++j) {
    const Eigen::Vector3d x = start.col(j);
    const bool of_floor_and_side = x.y() < p.tank.min.y() && (x.z() < 0 || x.z() > width) &&
                                   x.x() > p.tank.min.x() && x.x() < p.tank.max.x();
    if (!of_floor_and_side) continue;
    ++edges;
    EXPECT_LT(walls.projection(j, along).norm(), 1e-12);
    EXPECT_LT(resumed.projection(j, along).norm(), 1e-12);
  }
  EXPECT_GT(edges, 0);
}

// A layer that goes over the seam of a tank that sways along it stays on its edge.
TEST(WallContact, EdgesOfATankThatSwaysOverASeamKeepTheirDirection) {
  Parameters p = channel();
  p.periodic = {true, false, false};
  p.motion.amplitude = {0.03, 0, 0};
  p.motion.frequency = 1;
  p.end_time = 1;
  StepData<3> step(p, {}, {}, PairData::inverses, {});
  step.boundary.move_tank(step.state, 0.25, false);
  step.boundary.move_tank(step.state, 0.25, true);
  step.state.time = 0.25;
  const WallContact<3> resumed(step.boundary, step.state, l0);
  for (std::int64_t j = step.boundary.water(); j < step.boundary.first_of_bodies(); ++j)
    if (resumed.corner(j)) {
      EXPECT_EQ(resumed.projection(j, Eigen::Vector3d::UnitX()).norm(), 0);
    }
}

}  // namespace wall_wetting_test
}  // namespace strake::fluid
