#include "coupler/coupling/scheme.hpp"
#include "proto/interpolation.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

namespace strake {
namespace subcycling_test {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;

// Two masses on springs of their own, joined by a third one:
//   m1 x1'' = −k1 x1 − kc (x1 − x2),   m2 x2'' = −k2 x2 + kc (x1 − x2)
// The first plays the fluid, the second the structure; each takes steps of its own, four-stage Runge–Kutta.
constexpr double m1 = 1, k1 = 40, m2 = 2, k2 = 90, kc = 30, end_time = 1;

template <class Vector>
Vector runge_kutta(const Vector& y, double t, double h,
                   const std::function<Vector(double, const Vector&)>& f) {
  const Vector a = f(t, y), b = f(t + h / 2, y + h / 2 * a), c = f(t + h / 2, y + h / 2 * b),
               d = f(t + h, y + h * c);
  return y + h / 6 * (a + 2 * b + 2 * c + d);
}

/// Place and speed of a mass.
Field scalar(const std::string& quantity, const std::string& unit, double y) {
  return models::y_field(quantity, unit, VectorXd::Constant(1, y));
}

class FirstMass final : public models::Model<Vector4d> {
 public:
  explicit FirstMass(int steps) : steps_(steps) {
    begin(models::line_of_points("fluid", 1), Vector4d(0.1, 0, 0, 0));  // own place and speed, the other's
    description_.initial = {scalar("force", "N", kc * 0.1)};
  }

 private:
  Advanced step(const Window& w, const Input& input) override {
    const double x = models::y_of(input, "displacement")[0], v = models::y_of(input, "velocity")[0];
    // The other's place: the cubic through both ends of the window.
    const auto other = [&](double t) {
      const double s = (t - w.t) / w.dt, r = 1 - s;
      return (1 + 2 * s) * r * r * now_[2] + s * r * r * w.dt * now_[3] + s * s * (3 - 2 * s) * x -
             s * s * r * w.dt * v;
    };
    const auto rate = [&](double t, const Vector2d& y) -> Vector2d {
      return {y[1], (-k1 * y[0] - kc * (y[0] - other(t))) / m1};
    };
    Vector2d y = now_.head<2>();
    const double h = w.dt / steps_;
    Advanced answer;
    for (int k = 0; k < steps_; ++k) {
      y = runge_kutta<Vector2d>(y, w.t + k * h, h, rate);
      const double t = k + 1 == steps_ ? w.t + w.dt : w.t + (k + 1) * h;
      answer.history.push_back({t, {scalar("force", "N", kc * (y[0] - other(t)))}});
    }
    now_ << y, x, v;
    answer.output = answer.history.back().fields;
    return answer;
  }
  int steps_;
};

class SecondMass final : public models::Model<Vector2d> {
 public:
  SecondMass(int steps, Interpolation interpolation) : steps_(steps), interpolation_(interpolation) {
    begin(models::line_of_points("structure", 1), Vector2d(0, 0));
    description_.initial = {scalar("displacement", "m", 0), scalar("velocity", "m/s", 0)};
    description_.history = true;
  }

 private:
  Advanced step(const Window& w, const Input& input) override {
    const auto rate = [&](double t, const Vector2d& y) -> Vector2d {
      const double force = value_at(input.samples, "force", t, interpolation_)(1, 0);
      return {y[1], (-k2 * y[0] + force) / m2};
    };
    const double h = w.dt / steps_;
    for (int k = 0; k < steps_; ++k) now_ = runge_kutta<Vector2d>(now_, w.t + k * h, h, rate);
    Advanced answer;
    answer.output = {scalar("displacement", "m", now_[0]), scalar("velocity", "m/s", now_[1])};
    return answer;
  }
  int steps_;
  Interpolation interpolation_;
};

double exact() {
  const auto rate = [](double, const Vector4d& y) -> Vector4d {
    const double joint = kc * (y[0] - y[2]);
    return {y[1], (-k1 * y[0] - joint) / m1, y[3], (-k2 * y[2] + joint) / m2};
  };
  Vector4d y(0.1, 0, 0, 0);
  constexpr int n = 20000;
  for (int k = 0; k < n; ++k) y = runge_kutta<Vector4d>(y, 0, end_time / n, rate);
  return y[2];
}

double error_of(Interpolation interpolation, int windows, bool parallel) {
  FirstMass first(3);
  SecondMass second(5, interpolation);
  SchemeParameters parameters;
  parameters.parallel = parallel;
  // So near to round-off the compiler's choice of instructions decides whether a window converges. One may
  // stay above it (2e-12 m was seen under the sanitizers), far below the smallest measured error.
  constexpr double round_off = 5e-12;  // m
  parameters.convergence = {0, 1e-13, Measure::increment, 1, 60, Unconverged::accept};
  Scheme scheme(first, second, nearest_neighbour(second.mesh(), first.mesh()), parameters);
  for (int w = 0; w < windows; ++w) {
    EXPECT_LT(scheme.advance({w * end_time / windows, end_time / windows}).residual, round_off);
    scheme.commit(false);
  }
  return std::abs(second.state()[0] - exact());
}

TEST(SubCycling, HasTheOrderOfTheInterpolationOfTheLoadOverTheWindow) {
  const std::array<Interpolation, 4> kinds = {Interpolation::constant, Interpolation::linear,
                                              Interpolation::quadratic, Interpolation::b_spline};
  const char* names[] = {"constant", "linear", "quadratic", "b-spline"};
  for (const bool parallel : {false, true})
    for (int kind = 0; kind < 4; ++kind) {
      double before = 0, order = 0;
      for (const int windows : {20, 40, 80}) {
        const double error = error_of(kinds[static_cast<std::size_t>(kind)], windows, parallel);
        order = before > 0 ? std::log2(before / error) : 0;
        fmt::print("{:8}  {:9}  {:3} windows, 3 and 5 steps in each: error {:.2e} m  order {:.2f}\n",
                   parallel ? "parallel" : "serial", names[kind], windows, error, order);
        before = error;
      }
      EXPECT_GT(order, kind + 1 - 0.2);
    }
}

TEST(SubCycling, GoesOnBitEqualFromASavedState) {
  SchemeParameters parameters;
  parameters.convergence = {0, 1e-10, Measure::increment, 1, 60, Unconverged::stop};
  FirstMass first(3);
  SecondMass second(5, Interpolation::quadratic);
  Scheme scheme(first, second, nearest_neighbour(second.mesh(), first.mesh()), parameters);
  const auto windows = [&](Scheme& s, int from, int to) {
    for (int w = from; w < to; ++w) {
      s.advance({0.05 * w, 0.05});
      s.commit(false);
    }
    return second.state();
  };
  windows(scheme, 0, 5);
  Archive archive;
  scheme.state().save(archive);
  const FirstMass first_then = first;
  const SecondMass second_then = second;
  const Vector2d whole = windows(scheme, 5, 10);
  first = first_then;
  second = second_then;
  CouplingState state;
  state.load(archive);
  Scheme resumed(first, second, nearest_neighbour(second.mesh(), first.mesh()), parameters);
  resumed.set_state(state);
  EXPECT_EQ(windows(resumed, 5, 10), whole);
}

TEST(SubCycling, HoldsTheMeanWhereTheStructureAsksForNoHistory) {
  FirstMass first(3);
  struct Deaf final : models::Model<Vector2d> {
    std::size_t samples = 0;
    Deaf() { begin(models::line_of_points("structure", 1), Vector2d(0, 0)); }
    Advanced step(const Window&, const Input& input) override {
      samples = input.samples.size();
      Advanced answer;
      answer.output = {scalar("displacement", "m", 0)};
      return answer;
    }
  } deaf;
  Scheme scheme(first, deaf, nearest_neighbour(deaf.mesh(), first.mesh()), {});
  scheme.advance({0, 0.1});
  EXPECT_EQ(deaf.samples, 1u);
}

TEST(Interpolation, OfABSplineIsExactForCubicsAndSmoothBetweenItsPieces) {
  std::vector<Sample> samples;
  const auto sample = [&](double t, double value) {
    samples.push_back({t, {{"force", "N", true, MatrixXd::Constant(1, 1, value)}}});
  };
  const auto at = [&](double t) { return value_at(samples, "force", t, Interpolation::b_spline).value(); };
  const auto f = [](double t) { return 2 - 3 * t + 4 * t * t - 5 * t * t * t; };
  const auto integral = [](double t) {
    return 2 * t - 1.5 * t * t + 4 * t * t * t / 3 - 1.25 * t * t * t * t;
  };
  for (const double t : {0.0, 0.1, 0.25, 0.3, 0.5}) sample(t, f(t));
  for (const double t : {0.05, 0.1, 0.2, 0.27, 0.45, 0.5}) EXPECT_NEAR(at(t), f(t), 1e-14);
  EXPECT_NEAR(mean_over(samples, "force", 0.07, 0.43, Interpolation::b_spline).value(),
              (integral(0.43) - integral(0.07)) / 0.36, 1e-14);
  samples.resize(3);  // the parabola through three
  EXPECT_NEAR(at(0.2), value_at(samples, "force", 0.2, Interpolation::quadratic).value(), 1e-14);
  samples.resize(2);
  EXPECT_EQ(at(0.03), value_at(samples, "force", 0.03, Interpolation::linear).value());
  // Slope and curvature are the same from both sides of a sample, where a piecewise parabola has a kink.
  samples.clear();
  for (const double value : {0.0, 1.0, -1.0, 2.0, 0.5, 0.0})
    sample(0.1 * static_cast<double>(samples.size()), value);
  const double t = 0.3, h = 1e-4;
  const double left = (3 * at(t) - 4 * at(t - h) + at(t - 2 * h)) / (2 * h),
               right = (-3 * at(t) + 4 * at(t + h) - at(t + 2 * h)) / (2 * h);
  EXPECT_NEAR(left, right, 1e-2 * std::abs(left) + 1e-2);
}

TEST(Interpolation, IsExactForPolynomialsOfItsDegreeAndTheirMeans) {
  std::vector<Sample> samples;
  const auto f = [](double t) { return 2 - 3 * t + 4 * t * t; };
  const auto integral = [](double t) { return 2 * t - 1.5 * t * t + 4 * t * t * t / 3; };
  for (const double t : {0.0, 0.1, 0.25, 0.3, 0.5})
    samples.push_back({t, {{"force", "N", true, MatrixXd::Constant(1, 1, f(t))}}});
  for (const double t : {0.05, 0.1, 0.2, 0.27, 0.45, 0.5})
    EXPECT_NEAR(value_at(samples, "force", t, Interpolation::quadratic).value(), f(t), 1e-14);
  EXPECT_NEAR(mean_over(samples, "force", 0.07, 0.43, Interpolation::quadratic).value(),
              (integral(0.43) - integral(0.07)) / 0.36, 1e-14);
  // Linear: exact at the samples, and by the trapezoidal rule between them.
  EXPECT_EQ(value_at(samples, "force", 0.25, Interpolation::linear).value(), f(0.25));
  EXPECT_NEAR(mean_over(samples, "force", 0.1, 0.3, Interpolation::linear).value(),
              (0.15 * (f(0.1) + f(0.25)) + 0.05 * (f(0.25) + f(0.3))) / 0.4, 1e-14);
  // Constant: each sample since the one before it, so that the impulse of step means is kept.
  EXPECT_NEAR(mean_over(samples, "force", 0.2, 0.5, Interpolation::constant).value(),
              (0.05 * f(0.25) + 0.05 * f(0.3) + 0.2 * f(0.5)) / 0.3, 1e-14);
  EXPECT_EQ(value_at(samples, "force", 0.6, Interpolation::quadratic).value(), f(0.5));
}

}  // namespace subcycling_test
}  // namespace strake
