#include "fluid/viscosity/wall_law.hpp"

#include "tests/fluid/viscosity/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace strake::fluid {
namespace wall_law_test {

// u⁺ = y⁺ at the face, u⁺ = ln(y⁺)/0.41 + 5.0 far from it. At y⁺ = 1000 the logarithm gives 21.85.
TEST(WallLaw, is_the_straight_line_at_the_face_and_the_logarithm_far_from_it) {
  const WallLaw water{1e-6, 0.01};
  EXPECT_NEAR(std::pow(water.friction_velocity(1e-3, 1e-3), 2) / (1e-6 * 1e-3 / 1e-3), 1, 2e-3);  // y⁺ = 1
  const double u = 21.85, y_plus = 1000;  // at ν = 1e-6 and y = 1 mm u_τ is 1 m/s
  EXPECT_NEAR(water.friction_velocity(u, y_plus * 1e-6), 1, 2e-3);
  EXPECT_NEAR(water.friction_velocity(40, 1e12), 40 / (std::log(40e18) / 0.41), 0.2);  // any number ends
  for (const double none : {0.0, -1.0}) {
    EXPECT_EQ(water.friction_velocity(none, 1), 0);
    EXPECT_EQ(water.friction_velocity(1, none), 0);
    EXPECT_EQ((WallLaw{none, 0.01}.friction_velocity(1, 1)), 0);
  }
}

// A uniform stream of 3 m/s between walls at rest, y⁺ = 2000. Each wall takes ρ u_τ² per area, and what the
// water loses the layers feel, however the particles lie.
TEST(WallLaw, a_fast_stream_loses_u_tau_squared_per_area_of_wall_and_momentum_is_kept) {
  for (const double disorder : {0.0, 0.1}) {
    Channel channel(20, disorder);
    channel.parameters.scheme.turbulence = Turbulence::statics;
    channel.parameters.kinematic_viscosity = 1e-6;
    channel.velocity.row(0).head(channel.water).setConstant(3);
    const auto& a = channel.acceleration();
    const double u_tau = WallLaw{1e-6, channel.l0}.friction_velocity(3, 0.5 * channel.l0);
    const double expected = -2 * u_tau * u_tau * Channel::along / channel.l0;  // Σ a, of both walls
    const double sum = a.leftCols(channel.water).row(0).sum();
    EXPECT_NEAR(sum / expected, 1, disorder > 0 ? 0.1 : 0.02);
    EXPECT_NEAR(a.rightCols(channel.walls.size()).row(0).sum(), -sum, 1e-12 * std::abs(sum));
    // Friction acts on the water beside the wall alone.
    const auto inner = [&](std::int64_t i) {
      return channel.y(i) > 2 * channel.l0 && channel.y(i) < 1 - 2 * channel.l0;
    };
    double largest = 0;
    for (std::int64_t i = 0; i < channel.water; ++i)
      largest = std::max(largest, inner(i) ? std::abs(a(0, i)) : 0);
    EXPECT_LT(largest, 1e-9);
  }
}

// One drop that glides on the wall feels the friction of the one spacing that it covers, u_τ²/l0. The wall
// particles near it each act with their weight out of that of a covered face.
TEST(WallLaw, a_single_drop_feels_the_friction_of_its_own_width) {
  Channel channel(20);
  channel.parameters.scheme.turbulence = Turbulence::statics;
  channel.parameters.kinematic_viscosity = 1e-6;
  for (std::int64_t i = 0; i < channel.water; ++i)
    if (i != 8) channel.position(1, i) = 0.5;  // far from the walls
  channel.velocity(0, 8) = 3;
  channel.near = &channel.search.update(channel.position);
  const double u_tau = WallLaw{1e-6, channel.l0}.friction_velocity(3, 0.5 * channel.l0);
  EXPECT_NEAR(channel.acceleration()(0, 8) / (-u_tau * u_tau / channel.l0), 1, 0.1);
}

// In the viscous sublayer, and without a turbulence model, the straight line through the face's velocity
// stays.
TEST(WallLaw, a_resolved_layer_and_a_flow_without_a_model_keep_the_straight_line) {
  for (const double nu : {1.0, 1e-6}) {
    Channel channel(20);
    channel.parameters.scheme.turbulence = nu == 1 ? Turbulence::statics : Turbulence::none;
    channel.parameters.kinematic_viscosity = nu;
    for (std::int64_t i = 0; i < channel.water; ++i) channel.velocity(0, i) = channel.y(i);
    for (std::int64_t w = 0; w < channel.walls.size(); ++w)
      if (channel.walls.normal(1, w) < 0) channel.walls.velocity(0, w) = 1;
    EXPECT_LT(channel.acceleration().leftCols(channel.water).cwiseAbs().maxCoeff(), 1e-11);
  }
}

}  // namespace wall_law_test
}  // namespace strake::fluid
