#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace strake::fluid {
namespace {

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

}  // namespace
}  // namespace strake::fluid
