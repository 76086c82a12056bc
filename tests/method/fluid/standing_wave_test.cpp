#include "tests/method/fluid/known_flows.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace strake::fluid {
namespace standing_wave_test {

/// Period of the wave [s], from its first and its third zero.
double period(double spacing) {
  Parameters p;
  p.spacing = spacing;
  p.tank.min = p.water.min = {0, 0, 0};
  p.tank.max = {1, 0.8, 0};
  p.water.max = {1, StandingWave::depth, 0};
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.threads = 1;
  Simulation<2> simulation(p, {}, {});
  StandingWave::start(simulation);
  const std::vector<double> zero = StandingWave::zeros(simulation, 3, 2);
  return zero.size() == 3 ? zero[2] - zero[0] : 0;
}

// The surface condition depends on the water's own place. Where p = 0 lies over a layer that the wave has
// stretched decides whether the error falls with the spacing or with its square.
TEST(StandingWave, PeriodConvergesWithMoreThanTheOrderThreeHalves) {
  const double theory = StandingWave::period(), coarse = period(0.05) / theory - 1,
               middle = period(0.025) / theory - 1, fine = period(0.0125) / theory - 1;
  const double order = 0.5 * std::log2(std::abs(coarse / fine));
  testing::Test::RecordProperty(
      "period", fmt::format("{:+.4f} {:+.4f} {:+.4f}, order {:.2f}", coarse, middle, fine, order));
  EXPECT_LT(std::abs(fine), 0.01);
  EXPECT_GT(order, 1.5);
  EXPECT_GT(std::log2(std::abs(coarse / middle)), 1.5);
}

}  // namespace standing_wave_test
}  // namespace strake::fluid
