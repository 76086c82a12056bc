#include "fluid/window_motion.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::fluid {
namespace window_motion_test {

TEST(WindowMotion, without_a_velocity_the_points_move_with_constant_acceleration) {
  const double x1 = 3e-4, v0 = 10.0, dt = 1e-4, a = 2 * (x1 - v0 * dt) / (dt * dt);
  const Points start = Points::Zero(3, 1), velocity = Eigen::Vector3d(0, v0, 0);
  const WindowMotion motion(
      {5.0, dt}, {{5.0 + dt, {{"displacement", "m", false, Eigen::Vector3d(0, x1, 0)}}}}, start, velocity);
  for (int k = 0; k < 4; ++k) {
    const double t0 = 5.0 + dt * k / 4, t1 = 5.0 + dt * (k + 1) / 4, s = t1 - 5.0;
    const auto step = motion.step(t0, t1);
    EXPECT_NEAR(step.displacement(1, 0), v0 * s + 0.5 * a * s * s, 1e-12);
    EXPECT_NEAR(step.velocity(1, 0), v0 + a * s, 1e-8);
    EXPECT_NEAR(step.acceleration(1, 0), a, 1e-6 * std::abs(a));
  }
  EXPECT_EQ(motion.step(5.0, 5.0 + dt).displacement(1, 0), x1);
}

TEST(WindowMotion, with_a_velocity_both_ends_are_met_exactly) {
  const Points start = Eigen::Vector3d(1, 2, 0), velocity = Eigen::Vector3d(0.5, -1, 0);
  const Eigen::Vector3d x1(1.2, 1.9, 0), v1(-3, 4, 0);
  const WindowMotion motion(
      {0, 0.1}, {{0.1, {{"displacement", "m", false, x1}, {"velocity", "m/s", false, v1}}}}, start, velocity);
  const auto end = motion.step(0.05, 0.1);
  EXPECT_EQ((end.displacement - x1).norm(), 0);
  EXPECT_EQ((end.velocity - v1).norm(), 0);
  // The velocity is the derivative of the place.
  const double h = 1e-6;
  const auto before = motion.step(0, 0.04 - h), after = motion.step(0, 0.04 + h),
             middle = motion.step(0, 0.04);
  EXPECT_LT(((after.displacement - before.displacement) / (2 * h) - middle.velocity).norm(), 1e-6);
}

TEST(WindowMotion, a_history_of_samples_is_followed_piece_by_piece) {
  const Points start = Points::Zero(3, 1);
  const auto sample = [](double t, double x, double v) {
    return Sample{t,
                  {{"displacement", "m", false, Eigen::Vector3d(x, 0, 0)},
                   {"velocity", "m/s", false, Eigen::Vector3d(v, 0, 0)}}};
  };
  const WindowMotion motion({0, 1}, {sample(0.5, 2, 1), sample(1, 3, -1)}, start, start);
  EXPECT_EQ(motion.step(0, 0.5).displacement(0, 0), 2);
  EXPECT_EQ(motion.step(0.5, 1).velocity(0, 0), -1);
}

TEST(WindowMotion, motion_of_another_number_of_points_is_an_error) {
  const Points start = Points::Zero(3, 2);
  EXPECT_THROW(
      WindowMotion({0, 1}, {{1, {{"displacement", "m", false, Eigen::Vector3d(0, 0, 0)}}}}, start, start),
      Error);
  EXPECT_THROW(WindowMotion({0, 1}, {{1, {}}}, start, start), Error);
}

}  // namespace window_motion_test
}  // namespace strake::fluid
