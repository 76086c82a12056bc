#include "coupler/coupling/scheme.hpp"
#include "tests/method/coupling/piston_models.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace strake {
namespace piston_test {

using Eigen::VectorXd;

constexpr double k = models::piston_stiffness, m = models::piston_mass, x0 = models::piston_start;

struct Piston {
  double added;  // ρℓ [kg/m²]
  models::AddedMass column;
  models::Oscillators spring;
  double period() const { return models::piston_period(added / m); }
};

Piston piston(double mu, bool send_velocity = false) {
  return {mu * m, models::piston_column(mu), models::piston_spring(send_velocity)};
}

struct Result {
  double mean_iterations = 0;
  int max_iterations = 0, unconverged = 0;
  double frequency = 0;     // [Hz]
  double energy_error = 0;  // largest over a period, relative to the energy at its start
  double work_gap = 0;
};

/// Ten periods with dt = T/100.
Result ten_periods(double mu, const std::string& kind, double relative, bool send_velocity = false) {
  Piston p = piston(mu, send_velocity);
  const double dt = p.period() / 100;
  SchemeParameters parameters;
  parameters.convergence = {relative, 1e-16, Measure::increment, 1, 20, Unconverged::accept};
  parameters.accelerator.kind = kind;
  Scheme scheme(p.column, p.spring, nearest_neighbour(p.spring.mesh(), p.column.mesh()), parameters);
  const auto energy = [&] {
    const auto& s = p.spring.state();
    return 0.5 * (m * s.v[0] * s.v[0] + p.added * std::pow(p.column.state().v[0], 2) + k * s.x[0] * s.x[0]);
  };
  Result run;
  double start = energy();
  std::vector<double> crossings;  // of zero, downwards
  double before = x0;
  for (int w = 0; w < 1000; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    scheme.commit(false);
    run.mean_iterations += report.iterations / 1000.0;
    run.max_iterations = std::max(run.max_iterations, report.iterations);
    if (!report.converged) ++run.unconverged;
    run.work_gap = std::max(run.work_gap, report.work.gap());
    const double x = report.displacement(1, 0);
    if (before > 0 && x <= 0) crossings.push_back((w + before / (before - x)) * dt);
    before = x;
    run.energy_error = std::max(run.energy_error, std::abs(energy() / start - 1));
    if (w % 100 == 99) start = energy();
  }
  run.frequency = static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  return run;
}

TEST(Piston, HasTheFixedPointFactorOfItsMassRatio) {
  for (const double mu : {0.5, 1.0, 2.0, 10.0, 100.0}) {
    Piston p = piston(mu);
    const Window window = {0, p.period() / 100};
    const auto image = [&](double x) {
      const Sample motion = {window.dt, {models::y_field("displacement", "m", VectorXd::Constant(1, x))}};
      const Advanced wet = p.column.advance(window, {{motion}});
      const Advanced dry = p.spring.advance(window, {{{window.dt, wet.output}}});
      p.column.rewind();
      p.spring.rewind();
      return dry.output.front().value(1, 0);
    };
    const double factor = (image(2e-3) - image(1e-3)) / 1e-3;
    const double exact = -p.added / (m + 0.25 * window.dt * window.dt * k);
    fmt::print("mu {:4}  fixed-point factor {:.6f}, exact {:.6f}\n", mu, factor, exact);
    EXPECT_NEAR(factor, exact, 1e-9 * std::abs(exact));  // differences of round-off
  }
}

TEST(Piston, ConvergesInThreeIterationsAndKeepsFrequencyAndEnergy) {
  for (const double mu : {0.5, 1.0, 2.0, 10.0, 100.0}) {
    const double exact = 1 / piston(mu).period();
    for (const char* kind : {"aitken", "iqn-ils"})
      for (const bool send_velocity : {false, true}) {
        const Result run = ten_periods(mu, kind, 1e-9, send_velocity);
        fmt::print(
            "mu {:4}  {:7}  {:12}  iterations mean {:.2f} max {}  frequency {:+.4f} %  energy {:.1e}\n", mu,
            kind, send_velocity ? "velocity too" : "displacement", run.mean_iterations, run.max_iterations,
            100 * (run.frequency / exact - 1), run.energy_error);
        EXPECT_LE(run.max_iterations, 3);
        EXPECT_EQ(run.unconverged, 0);
        EXPECT_NEAR(run.frequency / exact, 1, 1e-3);  // the trapezoidal rule itself: 0.033 %
        EXPECT_LT(run.energy_error, 1e-6);
        EXPECT_LT(run.work_gap, 1e-12);
      }
  }
}

// The default tolerance leaves a residual in each window that the recurrence v' = 2(x' − x)/dt − v keeps.
TEST(Piston, KeepsItsFrequencyAtTheDefaultTolerance) {
  for (const double mu : {0.5, 10.0}) {
    const Result run = ten_periods(mu, "iqn-ils", Convergence{}.relative);
    fmt::print("mu {:4}  default tolerance: iterations mean {:.2f}  energy {:.1e} per period\n", mu,
               run.mean_iterations, run.energy_error);
    EXPECT_NEAR(run.frequency * piston(mu).period(), 1, 1e-3);
  }
}

/// One window from rest at x0 with x + ω (H(x) − x), to a relative 1e-9.
WindowReport one_window(double mu, double relaxation) {
  Piston p = piston(mu);
  SchemeParameters parameters;
  parameters.convergence = {1e-9, 0, Measure::increment, 1, 20, Unconverged::accept};
  parameters.accelerator = {"constant", relaxation, 0, 0};
  Scheme scheme(p.column, p.spring, nearest_neighbour(p.spring.mesh(), p.column.mesh()), parameters);
  return scheme.advance({0, p.period() / 100});
}

TEST(Piston, GrowsOrShrinksByItsFactorWithoutRelaxation) {
  for (const double mu : {0.5, 2.0, 10.0}) {
    const WindowReport report = one_window(mu, 1);
    EXPECT_NEAR(report.log[5].residual / report.log[4].residual, mu,
                0.02 * mu);  // the Δt² term in the factor
    EXPECT_FALSE(mu > 1 && report.converged);
  }
}

TEST(Piston, ConvergesAtOnceWithTheBestConstantRelaxation) {
  for (const double mu : {0.5, 1.0, 2.0, 10.0, 100.0}) {
    const double dt = piston(mu).period() / 100, factor = -mu * m / (m + 0.25 * dt * dt * k);
    const WindowReport report = one_window(mu, 1 / (1 - factor));
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.iterations, 2);
  }
}

}  // namespace piston_test
}  // namespace strake
