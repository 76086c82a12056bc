#pragma once

#include "fluid/particles/state.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace strake::fluid {

/// Water that turns about a point 0.15 m down, 2 m/s at 1.1 a. u = 3.14 m/s (1 − exp(−r²/a²)) a/r, a = 0.025
/// m. Returns how many particles of water there are; they come first.
inline std::int64_t set_turning(State<2>& state) {
  constexpr double radius = 0.025;
  const Vector<2> centre(0, -0.15);
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  for (std::int64_t i = 0; i < water; ++i) {
    const Vector<2> r = state.position.col(i) - centre;
    const double q = r.norm() / radius, turns = 3.14 * (1 - std::exp(-q * q)) / (q * r.norm());
    state.velocity.col(i) = turns * Vector<2>(-r[1], r[0]);
  }
  return water;
}

}  // namespace strake::fluid
