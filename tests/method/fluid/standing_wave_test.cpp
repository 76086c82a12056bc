#include "fluid/simulation/simulation.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace {

using std::numbers::pi;

constexpr double depth = 0.5, amplitude = 0.01, k = 2 * pi, g = 9.81;

// cases/VALIDATION.md, "Standing wave": ω² = g k tanh(kH), 0.8018 s; a standing wave of height a is slower by
// (ka)²/8, here 0.05 %.
double theory() {
  return 2 * pi / std::sqrt(g * k * std::tanh(k * depth)) * (1 + std::pow(k * amplitude, 2) / 8);
}

/// Period of the wave, from the first and the third zero of Σ cos(kx) cosh(ky) over the water. The water
/// starts at rest, displaced as the linear wave displaces it.
double period(double spacing) {
  Parameters p;
  p.spacing = spacing;
  p.tank.min = p.water.min = {0, 0, 0};
  p.tank.max = {1, 0.8, 0};
  p.water.max = {1, depth, 0};
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.threads = 1;
  Simulation<2> simulation(p, {}, {});
  State<2> displaced = simulation.state();
  for (std::size_t i = 0; i < displaced.kind.size() && displaced.kind[i] == Kind::fluid; ++i) {
    auto x = displaced.position.col(static_cast<Eigen::Index>(i));
    const double along = k * x[0], up = k * x[1], size = amplitude / std::sinh(k * depth);
    x[0] -= size * std::sin(along) * std::cosh(up);
    x[1] += size * std::cos(along) * std::sinh(up);
  }
  simulation.set_state(displaced);
  const State<2>& state = simulation.state();
  const auto wave = [&] {
    double sum = 0;
    for (std::size_t i = 0; i < state.kind.size() && state.kind[i] == Kind::fluid; ++i) {
      const auto x = state.position.col(static_cast<Eigen::Index>(i));
      sum += std::cos(k * x[0]) * std::cosh(k * x[1]);
    }
    return sum;
  };
  std::vector<double> zero;
  for (double before = wave(); zero.size() < 3 && state.time < 2;) {
    const double dt = simulation.stable_dt();
    simulation.step(dt, {});
    const double now = wave();
    if (before * now < 0) zero.push_back(state.time - dt * now / (now - before));
    before = now;
  }
  return zero.size() == 3 ? zero[2] - zero[0] : 0;
}

// The surface condition depends on the water's own place. Where p = 0 lies over a layer that the wave has
// stretched decides whether the error falls with the spacing or with its square.
TEST(StandingWave, PeriodConvergesWithMoreThanTheOrderThreeHalves) {
  const double coarse = period(0.05) / theory() - 1, middle = period(0.025) / theory() - 1,
               fine = period(0.0125) / theory() - 1;
  const double order = 0.5 * std::log2(std::abs(coarse / fine));
  testing::Test::RecordProperty(
      "period", fmt::format("{:+.4f} {:+.4f} {:+.4f}, order {:.2f}", coarse, middle, fine, order));
  EXPECT_LT(std::abs(fine), 0.01);
  EXPECT_GT(order, 1.5);
  EXPECT_GT(std::log2(std::abs(coarse / middle)), 1.5);
}

}  // namespace
}  // namespace strake::fluid
