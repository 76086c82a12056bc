#include "fluid/parameters/tank_motion.hpp"

#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace {

/// A function of time with its first two derivatives.
struct Jet {
  double value = 0, rate = 0, change = 0;
};

/// Returns the growth 10 τ³ − 15 τ⁴ + 6 τ⁵ of the amplitude from 0 to 1. It has no slope and no curvature at
/// either end.
Jet growth(double t, double ramp) {
  if (ramp <= 0 || t >= ramp) return {1, 0, 0};
  if (t <= 0) return {};
  const double s = t / ramp;
  return {s * s * s * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) * (1 - s) / ramp,
          60 * s * (1 - s) * (1 - 2 * s) / (ramp * ramp)};
}

/// Returns sin(2πft) times its growth.
Jet sine(double t, double frequency, double ramp) {
  const double omega = 2 * std::numbers::pi * frequency;
  const double s = std::sin(omega * t), c = omega * std::cos(omega * t);
  const Jet g = growth(t, ramp);
  return {g.value * s, g.rate * s + g.value * c, g.change * s + 2 * g.rate * c - g.value * omega * omega * s};
}

}  // namespace

RigidMotion TankMotion::at(double t) const {
  if (table) return table->at(t);
  RigidMotion motion;
  if (!moves()) return motion;
  const Jet jet = sine(t, frequency, ramp);
  motion.displacement = jet.value * amplitude;
  motion.velocity = jet.rate * amplitude;
  motion.acceleration = jet.change * amplitude;
  motion.angle = jet.value * roll;
  motion.angular_velocity = jet.rate * roll;
  motion.angular_acceleration = jet.change * roll;
  return motion;
}

Eigen::Vector3d TankMotion::reach(double end) const {
  if (!table) return amplitude.cwiseAbs();
  constexpr int samples = 1000;
  Eigen::Vector3d largest = Eigen::Vector3d::Zero();
  for (int k = 0; k <= samples; ++k)
    largest = largest.cwiseMax(table->at(end * k / samples).displacement.cwiseAbs());
  return largest;
}

}  // namespace strake::fluid
