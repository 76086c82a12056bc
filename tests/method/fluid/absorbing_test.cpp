#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace absorbing_test {

struct Column {
  double peak = 0;  // largest pressure on the plate while it moves, over ρcV
  double echo = 0;  // largest after the sound has been to the bottom and back, over the peak
};

enum class Below { bottom, absorbing_bottom, incompressible };

/// A column 0.5 m deep under a plate as wide as its tank. All of it or the upper half has sound. The plate is
/// pushed down once by V sin²(πt/T), T = H/(2c). Its sound is back at 2H/c.
Column push(Below below) {
  constexpr double depth = 0.5, c = 100, speed = 0.05, spacing = 0.01, width = 0.1;
  Parameters p = tank_case(width, depth, spacing, 0.2);
  p.sound_speed = c;
  p.absorbing_bottom = below == Below::absorbing_bottom;
  if (below == Below::incompressible) p.sound_depth = 0.5 * depth;
  p.gravity.setZero();
  p.scheme.tau = p.scheme.gamma = 0;  // no drift of the density: sound alone
  const InterfaceMesh plate = rectangle(-0.5 * width, 0, width, 0.05, spacing);
  Simulation<2> simulation(p, plate, Points::Zero(3, plate.position.cols()));
  const auto n = simulation.interface().position.cols();
  InterfaceMotion motion{Points::Zero(3, n), Points::Zero(3, n), Points::Zero(3, n)};
  const double push = 0.5 * depth / c, dt = 0.5 * spacing / c;
  Column column;
  double place = 0;
  for (double t = dt; t < 3 * depth / c; t += dt) {
    const double v = t < push ? speed * std::pow(std::sin(std::numbers::pi * t / push), 2) : 0;
    place -= v * dt;
    motion.displacement.row(1).setConstant(place);
    motion.velocity.row(1).setConstant(-v);
    simulation.step(dt, motion);
    const double pressure = simulation.interface_force().row(1).sum() / width / (p.density * c * speed);
    if (t < 1.2 * push) column.peak = std::max(column.peak, std::abs(pressure));
    if (t > 1.8 * (below == Below::incompressible ? p.sound_depth : depth) / c)
      column.echo = std::max(column.echo, std::abs(pressure));
  }
  column.echo /= column.peak;
  constexpr std::array name{"solid bottom", "absorbing bottom", "incompressible water below"};
  fmt::print("{}: first peak {:.3f} rho c V, echo {:.3f} of it\n", name.at(static_cast<std::size_t>(below)),
             column.peak, column.echo);
  return column;
}

// A solid bottom and the plate at rest: the echo counts twice, less what the steps have smeared.
TEST(Absorbing, ABottomThatYieldsSendsNoEchoBack) {
  const Column solid = push(Below::bottom), absorbing = push(Below::absorbing_bottom);
  EXPECT_NEAR(absorbing.peak, 1, 0.02);
  EXPECT_EQ(absorbing.peak, solid.peak);
  EXPECT_GT(solid.echo, 1.1);
  EXPECT_LT(absorbing.echo, 0.05);
}

// A jump to incompressible water would send all of it back. Theory: 2 % of waves of 25 l0, which these are.
TEST(Absorbing, WaterThatIsCompressibleNearItsSurfaceAloneSendsNoEchoBack) {
  const Column local = push(Below::incompressible);
  EXPECT_NEAR(local.peak, 1, 0.02);
  EXPECT_LT(local.echo, 0.05);
}

TEST(Absorbing, StillWaterStaysWhereOnlyItsUpperHalfIsCompressible) {
  constexpr double depth = 0.4, spacing = 0.02, g = 9.81;
  Parameters p = tank_case(0.4, depth, spacing, 0.2);
  p.sound_speed = 100;
  p.sound_depth = 0.2;
  Simulation<2> simulation(p, {}, {});
  for (int step = 0; step < 500; ++step) simulation.step(1e-3, {});
  EXPECT_NEAR(simulation.sensor_pressure({0, -depth, 0}, 0.2), p.density * g * depth,
              0.01 * p.density * g * depth);
  EXPECT_LT(simulation.state().velocity.colwise().norm().maxCoeff(), 0.02);
  EXPECT_EQ(simulation.state().lost, 0);
}

TEST(Absorbing, StillWaterStaysBetweenWallsThatYield) {
  constexpr double depth = 0.4, spacing = 0.02, g = 9.81;
  Parameters p = tank_case(0.4, depth, spacing, 0.2);
  p.sound_speed = 100;
  p.absorbing_bottom = p.absorbing_sides = true;
  Simulation<2> simulation(p, {}, {});
  for (int step = 0; step < 500; ++step) simulation.step(1e-3, {});
  const auto& state = simulation.state();
  double centre = 0;
  std::int64_t water = 0;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    centre += state.position(1, static_cast<Eigen::Index>(i));
    ++water;
  }
  EXPECT_NEAR(simulation.sensor_pressure({0, -depth, 0}, 0.2), p.density * g * depth,
              0.01 * p.density * g * depth);
  // Weight compresses the column by ρgH/(ρc²) = 4e-4 of its depth.
  EXPECT_NEAR(centre / static_cast<double>(water), -0.5 * depth, 0.02 * spacing);
  EXPECT_EQ(state.lost, 0);
}

}  // namespace absorbing_test
}  // namespace strake::fluid
