#include "tests/fluid/vortex.hpp"

#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake::fluid {
namespace vortex_test {

// The pressure in water that turns with U = 2 m/s falls below the air's. ρU² is larger than the depth's ρg
// 0.15 m. No air can get there.
TEST(Vortex, ACoreBelowThePressureOfTheAirStaysClosed) {
  Parameters p = tank_case(0.4, 0.3, 0.01, 0.2);
  p.sound_speed = std::numeric_limits<double>::infinity();
  Simulation<2> simulation(p, {}, {});
  State<2> start = simulation.state();
  const std::int64_t water = set_turning(start);
  simulation.set_state(start);
  const State<2>& state = simulation.state();
  double lowest = 0;
  std::int64_t inside = 0;
  while (state.time < 0.1) {
    simulation.step(simulation.stable_dt(), {});
    for (std::int64_t i = 0; i < water; ++i) {
      const bool deep = state.position(1, i) < -0.08;
      if (deep) lowest = std::min(lowest, state.pressure[i]);
      inside += deep && state.surface[static_cast<std::size_t>(i)] ? 1 : 0;
    }
  }
  EXPECT_EQ(inside, 0);
  EXPECT_LT(lowest, -500);
  EXPECT_EQ(state.lost, 0);
}

}  // namespace vortex_test
}  // namespace strake::fluid
