#pragma once

#include "fluid/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

// Flows of the plane whose answer is known, for tests of the method and the benchmark of its accuracy.

namespace strake::fluid {

inline std::int64_t water_of(const State<2>& state) {
  return std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
}

/// A standing wave of length 1 m on still water between x = 0 and 1 m (cases/VALIDATION.md, "Standing wave").
struct StandingWave {
  static constexpr double depth = 0.5, amplitude = 0.01;       // [m]
  static constexpr double k = 2 * std::numbers::pi, g = 9.81;  // [1/m], [m/s²]

  /// Period [s]: ω² = g k tanh(kH), 0.8018 s; a wave of height a is slower by (ka)²/8, here 0.05 %.
  static double period() {
    return 2 * std::numbers::pi / std::sqrt(g * k * std::tanh(k * depth)) *
           (1 + std::pow(k * amplitude, 2) / 8);
  }
  /// Starts the water at rest, displaced as the linear wave displaces it.
  static void start(Simulation<2>& simulation) {
    State<2> displaced = simulation.state();
    const std::int64_t water = water_of(displaced);
    for (std::int64_t i = 0; i < water; ++i) {
      auto x = displaced.position.col(i);
      const double along = k * x[0], up = k * x[1], size = amplitude / std::sinh(k * depth);
      x[0] -= size * std::sin(along) * std::cosh(up);
      x[1] += size * std::cos(along) * std::sinh(up);
    }
    simulation.set_state(displaced);
  }
  /// The first `count` times [s] at which Σ cos(kx) cosh(ky) over the water is zero; fewer where `end` [s]
  /// comes before.
  static std::vector<double> zeros(Simulation<2>& simulation, std::size_t count, double end) {
    const State<2>& state = simulation.state();
    const std::int64_t water = water_of(state);
    const auto wave = [&] {
      double sum = 0;
      for (std::int64_t i = 0; i < water; ++i)
        sum += std::cos(k * state.position(0, i)) * std::cosh(k * state.position(1, i));
      return sum;
    };
    std::vector<double> zero;
    for (double before = wave(); zero.size() < count && state.time < end;) {
      const double dt = simulation.stable_dt();
      simulation.step(dt, {});
      const double now = wave();
      if (before * now < 0) zero.push_back(state.time - dt * now / (now - before));
      before = now;
    }
    return zero;
  }
};

/// L2 error, relative, of the velocity along a channel 1 m wide that a unit force starts, ν = 1 m²/s, walls
/// without slip (cases/VALIDATION.md, "Viscous flows"):
///   u = ½ y (1 − y) − Σ 4/m³ sin(my) exp(−m² t),  m = (2n + 1)π.
inline double channel_error(const State<2>& state) {
  const std::int64_t water = water_of(state);
  double off = 0, all = 0;
  for (std::int64_t i = 0; i < water; ++i) {
    const double y = state.position(1, i);
    double u = 0.5 * y * (1 - y);
    for (int n = 0; n < 60; ++n) {
      const double m = (2 * n + 1) * std::numbers::pi;
      u -= 4 / (m * m * m) * std::sin(m * y) * std::exp(-m * m * state.time);
    }
    off += std::pow(state.velocity(0, i) - u, 2);
    all += u * u;
  }
  return std::sqrt(off / all);
}

}  // namespace strake::fluid
