#include "coupler/coupling/scheme.hpp"
#include "proto/error.hpp"
#include "proto/interpolation.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace strake {
namespace oscillator_test {

using Eigen::Vector3d;
using std::numbers::pi;

// Two equal masses on springs of their own, joined by a third one. Each solver has one mass, is given the
// place of the other, and takes four steps in a window. From (1, 0) at rest the exact motion is
//   x1, x2 = (cos 2πt ± cos 6πt)/2.
constexpr double m = 1, k = 4 * pi * pi, joint = 16 * pi * pi, end_time = 1;
constexpr int steps = 4;

double exact(double t, bool left) {
  return 0.5 * (std::cos(2 * pi * t) + (left ? 1 : -1) * std::cos(6 * pi * t));
}

/// What a solver knows of the other's place within a window.
enum class Knows { end, start_too, history };

Field place(double x) {
  return {"place", "m", false, Eigen::MatrixXd::Constant(1, 1, x)};
}

/// A mass by Newmark's rule of constant mean acceleration; the state is its place, speed and acceleration.
class Mass final : public models::Model<Vector3d> {
 public:
  Mass(bool left, Knows knows) : left_(left) {
    const double x = exact(0, left), other = exact(0, !left);
    begin(models::line_of_points(left ? "fluid" : "structure", 1),
          Vector3d(x, 0, (joint * other - (k + joint) * x) / m));
    description_.initial = {place(x)};
    description_.history = knows == Knows::history;
    description_.partner_initial = knows == Knows::start_too;
    if (left && knows == Knows::start_too) start_ = {{0, {place(other)}}};  // a fluid has it of its Setup
  }
  /// Largest departure from the exact motion, at the ends of all steps.
  double error() const { return error_; }
  int samples() const { return samples_; }
  void commit(bool write_output) override {
    Model::commit(write_output);
    error_ = std::max(error_, error_of_window_);
    start_ = {last_};
  }

 private:
  /// The other's place over the window, linear between the samples.
  std::vector<Sample> other_over(const Window& w, const Input& input) {
    samples_ = static_cast<int>(input.samples.size());
    last_ = input.samples.back();
    std::vector<Sample> other = input.samples;
    if (other.size() == 1) other.insert(other.begin(), start_.empty() ? Sample{w.t, {place(0)}} : start_[0]);
    return other;
  }
  Advanced step(const Window& w, const Input& input) override {
    const std::vector<Sample> other = other_over(w, input);
    const double h = w.dt / steps;
    Advanced answer;
    error_of_window_ = 0;
    for (int i = 1; i <= steps; ++i) {
      const double t = i == steps ? w.t + w.dt : w.t + i * h;
      const double pull = joint * value_at(other, "place", t, Interpolation::linear).value();
      const double x = now_[0], v = now_[1], a = now_[2], ahead = x + h * v + 0.25 * h * h * a;
      const double next = (pull - (k + joint) * ahead) / (m + 0.25 * h * h * (k + joint));
      now_ << ahead + 0.25 * h * h * next, v + 0.5 * h * (a + next), next;
      error_of_window_ = std::max(error_of_window_, std::abs(now_[0] - exact(t, left_)));
      if (input.wants_history) answer.history.push_back({t, {place(now_[0])}});
    }
    answer.output = {place(now_[0])};
    return answer;
  }
  bool left_;
  std::vector<Sample> start_;  // the other's place at the window's start, once it is known
  Sample last_;
  double error_ = 0, error_of_window_ = 0;
  int samples_ = 0;
};

struct Errors {
  double left = 0, right = 0, iterations = 0;
};

SchemeParameters parameters(bool parallel) {
  SchemeParameters made;
  made.parallel = parallel;
  made.convergence = {1e-10, 1e-13, Measure::value, 1, 100, Unconverged::stop};
  made.convergence.load.absolute = 1e-13;
  return made;
}

FieldTransfer between(const Mass& structure, const Mass& fluid) {
  return {nearest_neighbour(structure.mesh(), fluid.mesh()),
          nearest_neighbour(fluid.mesh(), structure.mesh())};
}

Errors errors_of(Knows knows, double window, bool parallel) {
  Mass left(true, knows), right(false, knows);
  Scheme scheme(left, right, between(right, left), parameters(parallel));
  const int windows = static_cast<int>(std::lround(end_time / window));
  Errors errors;
  for (int w = 0; w < windows; ++w) {
    errors.iterations += scheme.advance({w * window, window}).iterations / static_cast<double>(windows);
    scheme.commit(false);
  }
  errors.left = left.error();
  errors.right = right.error();
  return errors;
}

TEST(TwoMassOscillator, HasTheOrderOfItsSolversWhereHistoriesGoBothWays) {
  for (const bool parallel : {false, true}) {
    Errors before = {};
    for (const double window : {0.02, 0.01, 0.005}) {
      const Errors now = errors_of(Knows::history, window, parallel);
      fmt::print("{:8}  window {:5} s, {} steps in each: error {:.5f} and {:.5f} m, {:.1f} iterations\n",
                 parallel ? "parallel" : "serial", window, steps, now.left, now.right, now.iterations);
      if (window <= 0.01) {
        EXPECT_LE(std::max(now.left, now.right), 0.005);
      }
      if (before.left > 0) {
        EXPECT_GT(std::log2(before.left / now.left), 1.9);
        EXPECT_GT(std::log2(before.right / now.right), 1.9);
      }
      before = now;
    }
  }
}

TEST(TwoMassOscillator, NeedsTheStartOfTheOtherAndGainsByItsHistory) {
  std::array<double, 3> error{};
  for (const Knows knows : {Knows::end, Knows::start_too, Knows::history}) {
    const Errors found = errors_of(knows, 0.01, false);
    error[static_cast<std::size_t>(knows)] = std::max(found.left, found.right);
    fmt::print("knows {}: error {:.5f} and {:.5f} m\n", static_cast<int>(knows), found.left, found.right);
  }
  EXPECT_GT(error[0], 0.03);    // the first window begins with a jump
  EXPECT_LT(error[1], 0.009);   // and with a straight line over each window
  EXPECT_LT(error[2], 0.0025);  // of the solvers' own steps
}

TEST(TwoMassOscillator, GivesTheFirstWindowAloneTheStart) {
  Mass left(true, Knows::start_too), right(false, Knows::start_too);
  Scheme scheme(left, right, between(right, left), parameters(false));
  for (const int samples : {2, 1, 1}) {
    scheme.advance({scheme.state().windows * 0.01, 0.01});
    EXPECT_EQ(right.samples(), samples);
    EXPECT_EQ(left.samples(), 1);
    scheme.commit(false);
  }
}

TEST(TwoMassOscillator, GoesOnBitEqualFromASavedState) {
  Mass left(true, Knows::history), right(false, Knows::history);
  Scheme scheme(left, right, between(right, left), parameters(true));
  const auto windows = [&](Scheme& s, int from, int to) {
    for (int w = from; w < to; ++w) {
      s.advance({0.01 * w, 0.01});
      s.commit(false);
    }
    return Vector3d(left.state()[0], right.state()[0], left.samples());
  };
  windows(scheme, 0, 5);
  Archive archive;
  scheme.state().save(archive);
  const Mass left_then = left, right_then = right;
  const Vector3d whole = windows(scheme, 5, 10);
  EXPECT_EQ(whole[2], 3 + steps);  // three before the window, and those of it
  left = left_then;
  right = right_then;
  CouplingState state;
  state.load(archive);
  Scheme resumed(left, right, between(right, left), parameters(true));
  resumed.set_state(state);
  EXPECT_EQ(windows(resumed, 5, 10), whole);
}

/// A structure that answers with what the test gives.
struct Told final : models::Model<double> {
  Advanced answer;
  Told() {
    begin(models::line_of_points("structure", 1), 0);
    description_.initial = {place(0)};
  }
  Advanced step(const Window&, const Input&) override { return answer; }
};

TEST(TwoMassOscillator, RefusesSamplesOfAStructureThatLieOutsideTheWindow) {
  for (const std::array<double, 2>& times : {std::array{0.005, 0.02}, {0.007, 0.006}, {0.0, 0.01}}) {
    Mass left(true, Knows::history);
    Told right;
    right.answer.output = {place(0)};
    for (const double t : times) right.answer.history.push_back({t, {place(0)}});
    Scheme scheme(
        left, right,
        {nearest_neighbour(right.mesh(), left.mesh()), nearest_neighbour(left.mesh(), right.mesh())},
        parameters(false));
    try {
      scheme.advance({0, 0.01});
      ADD_FAILURE() << times[0] << " and " << times[1] << " were taken";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::solver_fault);
      EXPECT_EQ(e.where(), "structure, window 1 (t = 0 s), iteration 1");
      EXPECT_TRUE(e.problem().starts_with("sent a sample at ")) << e.problem();
    }
  }
}

}  // namespace oscillator_test
}  // namespace strake
