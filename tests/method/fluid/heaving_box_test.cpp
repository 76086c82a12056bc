#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace strake::fluid {
namespace heaving_box_test {

// A floating box heaves by 8 mm about a place 8 mm deeper, at 0.039 m/s at most. The water turns round its
// sharp corners. While particles lost sight of each other behind a corner, single ones were thrown at 0.25
// m/s, and the force jumped by 465 N/m from one step to the next.
TEST(HeavingBox, WaterFlowsRoundItsCornersWithoutThrowingParticles) {
  constexpr double spacing = 0.02, dt = 2e-3, amplitude = 8e-3, period = 1.28;
  Parameters p = tank_case(2.0, 0.6, spacing);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.submerged = true;
  const InterfaceMesh box = rectangle(-0.2, -0.2, 0.4, 0.4, spacing);
  const Points still = Points::Zero(3, box.position.cols());
  Simulation<2> simulation(p, box, still);
  InterfaceMotion motion{still, still, still};
  double height = 0, fastest = 0, jump = 0, before = 0;
  for (int step = 1; step * dt < 0.8 * period; ++step) {
    const double next = -amplitude * (1 - std::cos(2 * std::numbers::pi * step * dt / period));
    motion.velocity.row(1).setConstant((next - height) / dt);
    motion.displacement.row(1).setConstant(next);
    height = next;
    simulation.step(dt, motion);
    const double force = simulation.interface_force().row(1).sum();
    if (step > 2) jump = std::max(jump, std::abs(force - before));
    before = force;
    fastest = std::max(fastest, simulation.fastest().value);
  }
  fmt::print("heaving box: water at most {:.3f} m/s; force changes by {:.1f} N/m per step at most\n", fastest,
             jump);
  EXPECT_LT(fastest, 0.12);
  EXPECT_LT(jump, 50);
}

/// Mean force [N/m] from 4 to 12 ms on a box 0.4 m wide and 0.1 m deep that is lifted from rest at 20 m/s².
double force_while_lifted(bool negative_pressure) {
  constexpr double spacing = 0.02, dt = 5e-4, lift = 20;
  Parameters p = tank_case(2.0, 0.6, spacing);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.submerged = true;
  p.scheme.negative_pressure = negative_pressure;
  const InterfaceMesh box = rectangle(-0.2, -0.1, 0.4, 0.4, spacing);
  const Points still = Points::Zero(3, box.position.cols());
  Simulation<2> simulation(p, box, still);
  InterfaceMotion motion{still, still, still};
  motion.acceleration.row(1).setConstant(lift);
  double sum = 0;
  for (int step = 1; step <= 24; ++step) {
    const double t = step * dt;
    motion.velocity.row(1).setConstant(lift * t);
    motion.displacement.row(1).setConstant(0.5 * lift * t * t);
    simulation.step(dt, motion);
    if (step > 8) sum += simulation.interface_force().row(1).sum() / 16;
  }
  return sum;
}

// The water holds a box that is lifted: F = ρ g A − m_a dV/dt, A = 0.04 m², m_a the added mass. That of its
// bottom as a plate, ½πρa² = 63 kg/m, is a lower bound of it. Without tension the water let go of the box in
// the first steps, and F was 0.
TEST(LiftedBox, TheWaterFollowsItFromRest) {
  const double force = force_while_lifted(false), with_tension = force_while_lifted(true);
  fmt::print("lifted box: {:.0f} N/m; {:.0f} N/m where all water carries tension\n", force, with_tension);
  const double bound = 1000 * 9.81 * 0.04 - 63 * 20;
  EXPECT_LT(force, bound);
  EXPECT_LT(with_tension, bound);
}

/// Force along x [N/m] on the left half of a box 0.04 m wide and 0.3 m high, 0.1 m under the water, in its
/// first step. Its sides move towards each other with the acceleration `squeeze` [m/s²].
double force_while_squeezed(double squeeze) {
  constexpr double dt = 1e-4;
  Parameters p = tank_case(1.0, 0.6, 0.01);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.submerged = true;
  const InterfaceMesh box = rectangle(-0.02, -0.4, 0.04, 0.3, 0.01);
  const Points still = Points::Zero(3, box.position.cols());
  Simulation<2> simulation(p, box, still);
  InterfaceMotion motion{still, still, still};
  motion.acceleration.row(0) = -squeeze / 0.02 * box.position.row(0);
  motion.velocity = dt * motion.acceleration;
  motion.displacement = 0.5 * dt * motion.velocity;
  simulation.step(dt, motion);
  double sum = 0;
  for (Eigen::Index k = 0; k < box.position.cols(); ++k)
    if (box.position(0, k) < 0) sum += simulation.interface_force()(0, k);
  return sum;
}

// The load of water at rest on a wall that swings is linear in its acceleration, into suction too. While
// suction ended at the water's own pressure, the iterations of soft walls met a kink in every window.
TEST(SqueezedBox, SuctionIsAsLargeAsThePushOfTheOtherDirection) {
  constexpr double squeeze = 100;
  const double still = force_while_squeezed(0), in = force_while_squeezed(squeeze),
               out = force_while_squeezed(-squeeze);
  fmt::print("squeezed box: {:.1f} N/m at rest, {:.1f} inwards, {:.1f} outwards\n", still, in, out);
  EXPECT_LT(in, 0);
  EXPECT_NEAR(in + out, 2 * still, 0.01 * (out - in));
}

}  // namespace heaving_box_test
}  // namespace strake::fluid
