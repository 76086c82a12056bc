#include "fluid/interface_load.hpp"
#include "tests/fluid/plate_case.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace strake::fluid {
namespace {

struct Tank {
  Gradient gradient;
  double width, depth, spacing;  // [m]
  double dt, from, end;          // [s] the mean runs from `from` to `end`
};

struct Mean {
  double floor = 0, bottom = 0;  // over ρgHL and ρgH
  double gap = 0;                // momentum gap over the weight's impulse
};

Mean still_tank(const Tank& tank) {
  Parameters p = tank_case(tank.width, tank.depth, tank.spacing);
  p.scheme.gradient = tank.gradient;
  Simulation<2> simulation(p, {}, {});
  const InterfaceMotion none;
  Mean mean;
  int count = 0;
  const int steps = static_cast<int>(std::lround(tank.end / tank.dt));
  for (int k = 0; k < steps; ++k) {
    simulation.step(tank.dt, none);
    if (k * tank.dt < tank.from) continue;
    mean.floor -= simulation.floor_force()[1];
    mean.bottom += simulation.sensor_pressure({0, -tank.depth, 0}, 0.2);
    ++count;
  }
  const double head = p.density * 9.81 * tank.depth;
  mean.floor /= count * head * tank.width;
  mean.bottom /= count * head;
  const double mass = p.density * p.spacing * p.spacing;
  mean.gap = momentum_gap(simulation.state(), mass).norm() / simulation.state().impulse_of_gravity.norm();
  EXPECT_EQ(simulation.state().lost, 0);
  return mean;
}

void expect_weight(const Tank& tank) {
  const Mean mean = still_tank(tank);
  testing::Test::RecordProperty("floor", fmt::format("{:.4f}", mean.floor));
  testing::Test::RecordProperty("bottom", fmt::format("{:.4f}", mean.bottom));
  EXPECT_NEAR(mean.floor, 1, 0.01);
  EXPECT_NEAR(mean.bottom, 1, 0.01);
}

// The pressure is zero in the middle of the surface row, half a spacing below the surface: l0/2H = 0.8 %.
TEST(StillTank, FloorCarriesTheWeightWithTheMinimumPressureGradient) {
  expect_weight({Gradient::min_pressure, 0.3, 0.6, 0.01, 5e-4, 0.05, 0.25});
}
TEST(StillTank, FloorCarriesTheWeightWithTheCorrectedGradient) {
  expect_weight({Gradient::corrected, 0.3, 0.6, 0.01, 5e-4, 0.05, 0.25});
}
// The square lattice gives way under the symmetric gradient, and the water heaves until it has settled.
TEST(StillTank, FloorCarriesTheWeightWithTheSymmetricGradientOnceTheLatticeHasSettled) {
  expect_weight({Gradient::pairwise, 1.0, 0.5, 0.02, 1e-3, 0.5, 1.0});
}

TEST(StillTank, SymmetricGradientClosesTheMomentumAccountToRoundOff) {
  // 300 steps of about 10 forces per particle, each with 1e-16 of round-off.
  EXPECT_LT(still_tank({Gradient::pairwise, 0.4, 0.4, 0.02, 5e-4, 0.1, 0.15}).gap, 1e-11);
}

}  // namespace
}  // namespace strake::fluid
