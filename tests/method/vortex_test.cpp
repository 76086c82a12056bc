#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fluid/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

namespace strake::fluid {
namespace {

// Water that turns about a point 0.15 m down, u = 1.57 U (1 − exp(−r²/a²)) a/r with U = 2 m/s at r = 1.1 a,
// a = 0.025 m: its pressure falls below the air's by more than the depth adds, ρU² against ρg 0.15 m. No air
// can get there.
TEST(Vortex, ACoreBelowThePressureOfTheAirStaysClosed) {
  constexpr double radius = 0.025, speed = 2;
  Parameters p = tank_case(0.4, 0.3, 0.01, 0.2);
  p.sound_speed = std::numeric_limits<double>::infinity();
  Simulation<2> simulation(p, {}, {});
  State<2>& state = simulation.mutable_state();
  const Vector<2> centre(0, -0.15);
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  for (std::int64_t i = 0; i < water; ++i) {
    const Vector<2> r = state.position.col(i) - centre;
    const double q = r.norm() / radius, turns = 1.57 * speed * (1 - std::exp(-q * q)) / (q * r.norm());
    state.velocity.col(i) = turns * Vector<2>(-r[1], r[0]);
  }
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

}  // namespace
}  // namespace strake::fluid
