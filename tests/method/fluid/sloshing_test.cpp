#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace sloshing_test {

constexpr double g = 9.81, pi = std::numbers::pi;
constexpr double length = 1.0, depth = 0.4;  // [m]
constexpr double dt = 2e-3;                  // [s]

/// ω² = g k tanh kH, k = π n/L.
double natural_frequency(int n) {
  const double k = pi * n / length;
  return std::sqrt(g * k * std::tanh(k * depth));
}

double grown(double t, double ramp) {
  return t < ramp ? 0.5 * (1 - std::cos(pi * t / ramp)) : 1.0;
}

MotionTable table_of(double end, std::size_t column, auto&& value) {
  std::vector<double> time, place;
  constexpr int rows = 400;
  for (int k = 0; k <= rows; ++k) {
    time.push_back(end * k / rows);
    place.push_back(value(time.back()));
  }
  constexpr auto absent = MotionColumn::absent;
  std::array<MotionColumn, 4> columns{absent, absent, absent, absent};
  std::array<std::vector<double>, 4> values;
  columns[column] = MotionColumn::place;
  values[column] = place;
  return {time, columns, values};
}

/// The water's centre in the tank's own frame, along x [m].
double centre(const Simulation<2>& simulation, const TankMotion& motion) {
  const auto& state = simulation.state();
  const RigidMotion frame = motion.at(state.time);
  const double c = std::cos(frame.angle), s = std::sin(frame.angle);
  const Eigen::Vector2d at = motion.pivot.head<2>() + frame.displacement.head<2>();
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    if (state.kind[i] != Kind::fluid) continue;
    const Eigen::Vector2d r = state.position.col(static_cast<Eigen::Index>(i)) - at;
    sum += motion.pivot.x() + c * r.x() + s * r.y();
    ++count;
  }
  return sum / count;
}

/// Linear theory: a surface η = Σ η_n cos k_n(x + L/2) in a tank whose wall moves with the acceleration a,
///   η_n'' + ω_n² η_n = (4 tanh k_n H/(L k_n)) a, n odd; the water's centre x = Σ −2 η_n/(L H k_n²).
class LinearSloshing {
 public:
  double step(double acceleration, double dt) {
    double x = 0;
    for (int m = 0; m < modes; ++m) {
      const int n = 2 * m + 1;
      const double k = pi * n / length, omega = natural_frequency(n);
      const double force = 4 * std::tanh(k * depth) / (length * k) * acceleration;
      // The exact step of an oscillator under a constant force.
      const double c = std::cos(omega * dt), s = std::sin(omega * dt), rest = force / (omega * omega);
      auto& [eta, rate] = mode_[static_cast<std::size_t>(m)];
      const double old = eta - rest;
      eta = rest + old * c + rate / omega * s;
      rate = -old * omega * s + rate * c;
      x -= 2 * eta / (length * depth * k * k);
    }
    return x;
  }

 private:
  static constexpr int modes = 8;
  struct Mode {
    double eta = 0, rate = 0;
  };
  std::array<Mode, modes> mode_;
};

struct Sloshing {
  double error = 0;                // L2 of the centre's motion over that of linear theory
  double largest = 0, linear = 0;  // [m]
};

/// A tank shaken by 4 mm at `ratio` times its first natural frequency, for three of its periods.
Sloshing shake(double ratio, double spacing) {
  Parameters p = tank_case(length, depth, spacing, 0.2);
  const double omega = ratio * natural_frequency(1), end = 3 * 2 * pi / natural_frequency(1);
  p.end_time = end;
  p.motion.table =
      table_of(end, 0, [&](double t) { return 0.004 * grown(t, 2 * pi / omega) * std::sin(omega * t); });
  Simulation<2> simulation(p, {}, {});
  LinearSloshing linear;
  Sloshing run;
  double squares = 0, norm = 0;
  const double start = centre(simulation, p.motion);
  for (double t = 0; t < end - dt; t += dt) {
    simulation.step(dt, {});
    const double exact = linear.step(p.motion.at(t + 0.5 * dt).acceleration.x(), dt);
    const double x = centre(simulation, p.motion) - start;
    squares += (x - exact) * (x - exact);
    norm += exact * exact;
    run.largest = std::max(run.largest, std::abs(x));
    run.linear = std::max(run.linear, std::abs(exact));
  }
  run.error = std::sqrt(squares / norm);
  EXPECT_EQ(simulation.state().lost, 0);
  fmt::print(
      "shaken at {:.1f} f1, {:.0f} rows of water: centre moves {:.2f} mm, linear {:.2f} mm, L2 {:.3f}\n",
      ratio, depth / spacing, 1e3 * run.largest, 1e3 * run.linear, run.error);
  return run;
}

TEST(Sloshing, ATankShakenBelowAtAndAboveItsResonanceAnswersAsLinearTheory) {
  for (const double ratio : {0.7, 1.0, 1.3}) {
    const Sloshing run = shake(ratio, 0.02);
    EXPECT_NEAR(run.largest / run.linear, 1, 0.05);
    EXPECT_LT(run.error, 0.06);
  }
}

TEST(Sloshing, TheResponseNearsLinearTheoryAsTheSpacingShrinks) {
  const Sloshing coarse = shake(1.0, 0.02), fine = shake(1.0, 0.0125);
  EXPECT_LT(fine.error, 0.6 * coarse.error);
  EXPECT_LT(fine.error, 0.03);
}

// The tank is turned slowly, so that the surface stays level. In the tank it is tilted by −θ, and the centre
// lies −tan θ L²/(12 H) aside.
TEST(Sloshing, ATankThatIsTurnedSlowlyKeepsALevelSurface) {
  constexpr double angle = 4 * pi / 180;
  Parameters p = tank_case(length, depth, 0.02, 0.2);
  const double period = 2 * pi / natural_frequency(1), end = 4 * period;
  p.end_time = end;
  p.motion.pivot = {0.1, -0.2, 0};
  p.motion.table = table_of(end, 3, [&](double t) { return angle * grown(t, 3 * period); });
  Simulation<2> simulation(p, {}, {});
  const double start = centre(simulation, p.motion);
  double mean = 0;
  int count = 0;
  for (double t = 0; t < end - dt; t += dt) {
    simulation.step(dt, {});
    if (t < 3 * period) continue;
    mean += centre(simulation, p.motion) - start;
    ++count;
  }
  const double exact = -std::tan(angle) * length * length / (12 * depth);
  fmt::print("turned by 4 degrees: centre {:.2f} mm aside, level surface {:.2f} mm\n", 1e3 * mean / count,
             1e3 * exact);
  EXPECT_NEAR(mean / count, exact, 0.03 * std::abs(exact));
  EXPECT_EQ(simulation.state().lost, 0);
}

}  // namespace sloshing_test
}  // namespace strake::fluid
