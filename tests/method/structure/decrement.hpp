#pragma once

#include "structure/solver/solver.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace strake::structure {

/// δ/(2πζ/√(1 − ζ²)), the measured logarithmic decrement over its theory, of a body that swings in its first
/// mode. ω: of the undamped mode [rad/s]; ζ: the ratio of damping; X: where the swing is measured. The
/// amplitude of a period is its correlation with that mode's frequency, in which the others have next to no
/// share.
inline double decrement_over_theory(Solver& solver, double omega, double ratio, const Eigen::Vector3d& X) {
  constexpr int steps = 40, periods = 6;  // steps of a period
  const double damped = omega * std::sqrt(1 - ratio * ratio), dt = 2 * std::numbers::pi / damped / steps;
  std::vector<double> amplitude;
  for (int period = 0; period < periods; ++period) {
    double c = 0, s = 0;
    for (int k = 0; k < steps; ++k) {
      const double t = (period * steps + k) * dt;
      solver.advance(t, dt, {});
      const double y = solver.displacement_at(X).y();
      c += y * std::cos(damped * (t + dt));
      s += y * std::sin(damped * (t + dt));
    }
    amplitude.push_back(std::hypot(c, s));
  }
  const double decrement = std::log(amplitude.front() / amplitude.back()) / (periods - 1);
  return decrement / (2 * std::numbers::pi * ratio / std::sqrt(1 - ratio * ratio));
}

}  // namespace strake::structure
