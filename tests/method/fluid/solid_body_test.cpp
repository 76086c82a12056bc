#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/solid_case.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace strake::fluid {
namespace {

using Eigen::Vector3d;

/// The upward impulse of one step in which a body at the surface begins to move down, c = ∞ [N s].
double one_step_impulse(const InterfaceMesh& body, double spacing, double speed) {
  Parameters p = basin(0.6, 0.3, spacing, 0.06);
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.gravity.setZero();
  Points velocity = Points::Zero(3, body.position.cols());
  velocity.row(1).setConstant(-speed);
  Simulation<3> simulation(p, body, velocity);
  constexpr double dt = 1e-4;
  simulation.step(dt, {velocity * dt, velocity, Points::Zero(3, body.position.cols())});
  return dt * simulation.interface_force().row(1).sum();
}

// Half the added mass 8/3 ρa³ of a disc in a boundless fluid. What is left of the edge's singularity shrinks
// to 0.6 with each halving of the spacing, as for a strip in the plane (there measured over four spacings).
TEST(SolidBody, OneStepOfADiscHasItsAddedMass) {
  constexpr double radius = 0.1, speed = 5;
  const double exact = 4.0 / 3 * 1000 * std::pow(radius, 3) * speed;
  const auto impulse = [&](double spacing) {
    return one_step_impulse(disc_surface(radius, 0, 0.04, spacing), spacing, speed) / exact;
  };
  const double coarse = impulse(0.02), fine = impulse(0.01);
  fmt::print("disc, one step: {:.4f} of 4/3 rho a^3 V at 5 l0, {:.4f} at 10 l0\n", coarse, fine);
  EXPECT_LT(fine, coarse);
  EXPECT_NEAR((fine - 0.6 * coarse) / 0.4, 1, 0.06);
}

// Half of 0.4548 ρL³ (boundary elements, extrapolated; the handbooks' 0.579 π/4).
TEST(SolidBody, OneStepOfASquarePlateHasItsAddedMass) {
  constexpr double side = 0.2, speed = 5;
  const double exact = 0.5 * 0.4548 * 1000 * std::pow(side, 3) * speed;
  const auto impulse = [&](double spacing) {
    return one_step_impulse(box_surface({0, 0, 0}, {side, 0.04, side}, spacing), spacing, speed) / exact;
  };
  const double coarse = impulse(0.02), fine = impulse(0.01);
  fmt::print("square, one step: {:.4f} of 0.2274 rho L^3 V at 10 l0, {:.4f} at 20 l0\n", coarse, fine);
  EXPECT_LT(fine, coarse);
  EXPECT_NEAR((fine - 0.6 * coarse) / 0.4, 1, 0.08);
}

struct Lift {
  Vector3d force = Vector3d::Zero();  // mean over the last half
  double momentum_gap = 0;
};
Lift held_under_water(const InterfaceMesh& body, Parameters p, int steps) {
  p.submerged = true;
  const auto n = body.position.cols();
  Simulation<3> simulation(p, body, Points::Zero(3, n));
  const InterfaceMotion still{Points::Zero(3, n), Points::Zero(3, n), Points::Zero(3, n)};
  Lift lift;
  for (int step = 0; step < steps; ++step) {
    simulation.step(5e-4, still);
    if (2 * step >= steps) lift.force += 2.0 / steps * simulation.interface_force().rowwise().sum();
  }
  EXPECT_EQ(simulation.state().lost, 0);
  EXPECT_EQ(simulation.state().penetrations, 0);
  return lift;
}

TEST(SolidBody, ABoxUnderWaterIsLiftedByTheWaterItDisplaces) {
  const Vector3d size(0.16, 0.12, 0.16);
  const Lift lift = held_under_water(box_surface({0, -0.2, 0}, size, 0.02), basin(0.4, 0.28, 0.02, 0.08), 60);
  const double weight = 1000 * 9.81 * size.prod();
  fmt::print("box under water: {:.4f} of its displacement\n", lift.force.y() / weight);
  EXPECT_NEAR(lift.force.y(), weight, 0.02 * weight);
  EXPECT_LT(std::hypot(lift.force.x(), lift.force.z()), 0.01 * weight);
}

}  // namespace
}  // namespace strake::fluid
