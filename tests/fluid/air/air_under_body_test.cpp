#include "fluid/air/lower_faces.hpp"
#include "fluid/boundary/fill.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::fluid {
namespace air_under_body_test {

/// A wedge with its apex at (x, y), walked from there, 0.2 m wide.
InterfaceMesh wedge(double x, double y) {
  const std::array<Eigen::Vector2d, 5> corner = {
      {{x, y}, {x + 0.1, y + 0.03}, {x + 0.1, y + 0.06}, {x - 0.1, y + 0.06}, {x - 0.1, y + 0.03}}};
  InterfaceMesh mesh;
  mesh.name = "structure";
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, 5);
  mesh.faces.resize(2, 5);
  for (int k = 0; k < 5; ++k) {
    mesh.position.col(k).head<2>() = corner[static_cast<std::size_t>(k)];
    mesh.faces.col(k) << k, (k + 1) % 5;
  }
  return mesh;
}

InterfaceMesh both(InterfaceMesh one, const InterfaceMesh& other) {
  const auto points = one.position.cols(), faces = one.faces.cols();
  one.position.conservativeResize(3, points + other.position.cols());
  one.position.rightCols(other.position.cols()) = other.position;
  one.faces.conservativeResize(2, faces + other.faces.cols());
  one.faces.rightCols(other.faces.cols()) = other.faces.array() + static_cast<int>(points);
  return one;
}

TEST(AirUnderBody, EachOfTwoWedgesHasAFieldOfItsOwn) {
  const Parameters p = tank_case(1.0, 0.1, 0.01, 0.2);
  State<2> state = fill<2>(p);
  const Boundary<2> boundary(p, both(wedge(-0.2, 0.01), wedge(0.2, 0.01)), {}, state);
  const auto fields = lower_faces<2>(boundary, p.spacing);
  ASSERT_EQ(fields.size(), 2U);
  for (const auto& field : fields) {
    ASSERT_EQ(field.columns.size(), 20);
    for (int c = 0; c + 1 < 20; ++c)
      EXPECT_NEAR(field.columns.place(0, c + 1) - field.columns.place(0, c), 0.01, 1e-12);
  }
}

/// The force on a plate that falls onto the water with 2 m/s, seen from a tank that moves up or down with its
/// water.
double force_in_tank(double tank_speed, int steps) {
  Parameters p = tank_case(0.6, 0.2, 0.01, 0.2);
  p.air.layer = true;
  p.end_time = 1;
  constexpr auto absent = MotionColumn::absent;
  p.motion.table =
      MotionTable({0, 1}, {absent, MotionColumn::place, absent, absent}, {{{}, {0, tank_speed}, {}, {}}});
  const double speed = tank_speed - 2, dt = 5e-5;
  const InterfaceMesh plate = rectangle(-0.1, 0.002, 0.2, 0.02, 0.01);
  Simulation<2> simulation(p, plate, PlateEntry::down(plate, -speed));
  const auto m = simulation.interface().position.cols();
  InterfaceMotion motion{Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
  motion.velocity.row(1).setConstant(speed);
  for (int k = 1; k <= steps; ++k) {
    motion.displacement.row(1).setConstant(speed * k * dt);
    simulation.step(dt, motion);
  }
  return simulation.interface_force().row(1).sum();
}

TEST(AirUnderBody, TheCushionFollowsTheSpeedOfTheBodyAgainstTheWater) {
  for (const int steps : {1, 10}) {
    const double at_rest = force_in_tank(0, steps);
    EXPECT_GT(at_rest, 1000);
    for (const double speed : {-0.4, 0.4})
      EXPECT_NEAR(force_in_tank(speed, steps), at_rest, 1e-4 * at_rest) << steps;
  }
}

/// The impulse on a plate that falls onto the water with 6 m/s, up to 1.2 ms [N s/m].
double impulse_with(int columns, double dt = 5e-6) {
  Parameters p = tank_case(0.6, 0.2, 0.01, 0.2);
  p.air.layer = true;
  p.air.columns = columns;
  p.end_time = 1;
  constexpr double speed = 6;
  const InterfaceMesh plate = rectangle(-0.1, 0.002, 0.2, 0.02, 0.01);
  Simulation<2> simulation(p, plate, PlateEntry::down(plate, speed));
  const auto m = simulation.interface().position.cols();
  InterfaceMotion motion{Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
  motion.velocity.row(1).setConstant(-speed);
  double impulse = 0;
  for (int k = 1; k <= std::lround(1.2e-3 / dt); ++k) {
    motion.displacement.row(1).setConstant(-speed * k * dt);
    simulation.step(dt, motion);
    impulse += simulation.interface_force().row(1).sum() * dt;
  }
  return impulse;
}

// Where one of two columns under a wet point had hardly any air, its pressure stayed on the plate alone.
TEST(AirUnderBody, TwoColumnsUnderAWetPointGiveTheImpulseOfOne) {
  const double one = impulse_with(1);
  EXPECT_GT(one, 50);
  EXPECT_NEAR(impulse_with(2), one, 0.05 * one);
}

// Air that is given over to contact by the water's inertia in a step alone presses on in short steps: +14 %.
TEST(AirUnderBody, HalfTheStepGivesTheSameImpulse) {
  const double whole = impulse_with(1, 2.5e-6);
  EXPECT_NEAR(impulse_with(1, 1.25e-6), whole, 0.03 * whole);
}

}  // namespace air_under_body_test
}  // namespace strake::fluid
