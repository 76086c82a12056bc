#include "coupler/coupling/convergence.hpp"

#include "coupler/coupling/scheme.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "proto/error.hpp"
#include "tests/method/coupling/piston_models.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace convergence_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One window of the piston under half its mass of water, halving its error with each iteration or so.
WindowReport one_window(const Convergence& convergence, bool parallel = false, double part = 1) {
  models::AddedMass column = models::piston_column(0.5);
  models::Oscillators spring = models::piston_spring();
  SchemeParameters parameters;
  parameters.parallel = parallel;
  parameters.convergence = convergence;
  parameters.accelerator.kind = "constant";
  parameters.accelerator.initial_relaxation = 1;
  Scheme scheme(column, spring, nearest_neighbour(spring.mesh(), column.mesh()), parameters);
  return scheme.advance({0, part * models::piston_period(0.5) / 100});
}

constexpr Convergence nothing = {0, 0, Measure::increment, 1, 60, Unconverged::accept};

TEST(Convergence, MeetsEachLimitWhereItIsTheOnlyOne) {
  Convergence relative = nothing, absolute = nothing, to_first = nothing;
  relative.relative = 1e-4;
  absolute.absolute = 1e-9;
  to_first.residual_relative = 1e-5;
  const WindowReport by_relative = one_window(relative), by_absolute = one_window(absolute),
                     by_first = one_window(to_first);
  const auto last_two = [](const WindowReport& report) {
    return std::pair(report.log[report.log.size() - 2].residual, report.residual);
  };
  for (const WindowReport& report : {by_relative, by_absolute, by_first}) {
    EXPECT_TRUE(report.converged);
    EXPECT_GT(last_two(report).first, report.threshold);
    EXPECT_LE(last_two(report).second, report.threshold);
  }
  EXPECT_EQ(by_absolute.threshold, 1e-9);
  EXPECT_EQ(by_first.threshold, 1e-5 * by_first.log.front().residual);
  const double increment = std::abs(by_relative.displacement(1, 0) - models::piston_start);
  EXPECT_NEAR(by_relative.threshold, 1e-4 * increment, 1e-12 * increment);
}

TEST(Convergence, TakesTheLoosestLimitOfAFieldAndTheTightestField) {
  Convergence loose = nothing;
  loose.relative = 1e-2;
  loose.absolute = 1e-15;
  Convergence with_load = loose;
  with_load.load.relative = 1e-8;
  const WindowReport short_one = one_window(loose), long_one = one_window(with_load);
  EXPECT_LT(short_one.iterations + 5, long_one.iterations);
  ASSERT_EQ(long_one.log.back().fields.size(), 2u);
  const FieldResidual& force = long_one.log.back().fields[1];
  EXPECT_EQ(force.quantity, "force");
  EXPECT_TRUE(force.settled());
  EXPECT_FALSE(long_one.log[long_one.log.size() - 2].fields[1].settled());
  EXPECT_TRUE(long_one.log[long_one.log.size() - 2].fields[0].settled());
}

TEST(Convergence, MeasuresTheLoadAgainstWhatTheStructureWasGivenInAParallelScheme) {
  Convergence limits = nothing;
  limits.relative = 1e-6;
  const WindowReport parallel = one_window(limits, true), serial = one_window(limits);
  EXPECT_TRUE(parallel.converged);
  ASSERT_EQ(parallel.log.back().fields.size(), 2u);  // without a request
  EXPECT_NEAR(parallel.force(1, 0), serial.force(1, 0), 1e-5 * std::abs(serial.force(1, 0)));
  EXPECT_EQ(serial.log.back().fields.size(), 1u);
  for (const WindowReport& report : {parallel, serial})
    EXPECT_EQ(report.total_force(), report.force.rowwise().sum());
}

TEST(Convergence, IteratesAtLeastAndAtMostAsOftenAsAsked) {
  Convergence limits = nothing;
  limits.relative = 1;
  limits.min_iterations = 5;
  EXPECT_EQ(one_window(limits).iterations, 5);
  limits = nothing;
  limits.max_iterations = 4;
  const WindowReport report = one_window(limits);
  EXPECT_EQ(report.iterations, 4);
  EXPECT_FALSE(report.converged);
}

/// A spring of 200 N/m in the fluid under a free mass of 1 kg. Plain iteration multiplies its error by 200
/// dt².
class Spring final : public models::Model<double> {
 public:
  explicit Spring(double until = 1) : until_(until) { begin(models::line_of_points("fluid", 1), 0); }

 private:
  Advanced step(const Window& window, const Input& input) override {
    Advanced answer;
    answer.retry_smaller_dt = window.t > until_;
    answer.output = {models::y_field("force", "N", -200 * models::y_of(input, "displacement"))};
    return answer;
  }
  double until_;  // [s] from then on no window is short enough
};

TEST(Convergence, HalvesWindowsUntilTheyConverge) {
  Spring spring;
  models::Oscillators mass(MatrixXd::Identity(1, 1), MatrixXd::Zero(1, 1), VectorXd::Constant(1, 0.1),
                           VectorXd::Zero(1), models::Rule::backward);
  SchemeParameters parameters;
  parameters.convergence = {1e-6, 0, Measure::increment, 1, 10, Unconverged::halve};
  parameters.accelerator.kind = "constant";
  parameters.accelerator.initial_relaxation = 1;
  Scheme scheme(spring, mass, nearest_neighbour(mass.mesh(), spring.mesh()), parameters);
  WindowLoop loop(scheme, {.end = 0.5,
                           .window = 0.1,
                           .output_every = 0,
                           .start = {},
                           .control = {.smallest = 1e-3, .patience = 1000}});
  int windows = 0, taken_back = 0;
  while (!loop.finished()) {
    const CommittedWindow done = loop.next();
    EXPECT_TRUE(done.report.converged);
    taken_back += done.taken_back;
    ++windows;
  }
  EXPECT_EQ(loop.time(), 0.5);
  EXPECT_EQ(taken_back, 2);  // from 0.1 s, error times 2, over 0.05 s, halved in each of ten iterations
  EXPECT_EQ(windows, 20);    // of 0.025 s, error times 1/8
  EXPECT_EQ(scheme.state().windows, windows);
}

TEST(DefaultResidual, GoesWithTheSquareOfTheWindow) {
  // A body's acceleration is the displacement over Δt²: 0.02 m/s² at any window.
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-4), 2e-10);
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-5), 2e-12);
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-2), 1e-8) << "never looser than 1e-6 l0";
  EXPECT_DOUBLE_EQ(default_residual(0.01, 1e-9), 1e-13) << "never below round-off";
}

TEST(DefaultResidual, IsThatOfEachWindow) {
  Convergence limits = nothing;
  limits.spacing = 10;
  const double whole = one_window(limits).threshold, half = one_window(limits, false, 0.5).threshold;
  EXPECT_GT(whole, 0);
  EXPECT_DOUBLE_EQ(half, whole / 4);
}

// A shorter window is no advice where the iterations failed before.
TEST(Convergence, WindowsAcceptedUnconvergedAreSaidWhereTheRunEnds) {
  for (const int iterations : {3, 60}) {
    Spring spring(0.15);
    models::Oscillators mass(MatrixXd::Identity(1, 1), MatrixXd::Zero(1, 1), VectorXd::Constant(1, 0.1),
                             VectorXd::Zero(1), models::Rule::backward);
    SchemeParameters parameters;
    parameters.convergence = {1e-6, 0, Measure::increment, 1, iterations, Unconverged::accept};
    parameters.accelerator.kind = "constant";
    parameters.accelerator.initial_relaxation = 0.3;
    Scheme scheme(spring, mass, nearest_neighbour(mass.mesh(), spring.mesh()), parameters);
    RunPlan plan = {.end = 0.5, .window = 0.1, .output_every = 0};
    plan.if_halving_failed = "shorter windows do not help";
    WindowLoop loop(scheme, plan);
    const bool failed = !loop.next().report.converged && !loop.next().report.converged;
    if (!failed) loop.next();
    EXPECT_EQ(failed, iterations == 3);
    try {
      loop.next();
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(
          error.fix() == "2 of 2 windows before it were accepted unconverged: shorter windows do not help",
          failed)
          << error.fix();
    }
  }
}

}  // namespace convergence_test
}  // namespace strake
