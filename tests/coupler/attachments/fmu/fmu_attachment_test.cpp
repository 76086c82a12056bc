#include "tests/coupler/attachments/fmu/fmu_case.hpp"

#include <Eigen/LU>

#include <cmath>

namespace strake {
namespace fmu_attachment_test {

using Eigen::MatrixXd;

constexpr double stiffness = 4000, mass = 2.5;  // [N/m] [kg]
const double omega = std::sqrt(stiffness / mass);

std::vector<std::string> spring_and_mass() {
  return {"k = 4000", "m = 2.5", "longest = 1e-4"};
}

TEST(FmuAttachment, SaysItsPointsForceAndColumns) {
  FmuParameters p = oscillator_of(spring_and_mass());
  p.file = packed_fmu;
  const FmuAttachment fmu(p, setup_of(2));
  EXPECT_EQ(fmu.mesh().name, "damper");
  EXPECT_EQ(fmu.mesh().position.cols(), 2);
  EXPECT_EQ(fmu.mesh().faces.cols(), 0);
  const Description& description = fmu.description();
  ASSERT_EQ(description.initial.size(), 1u);
  EXPECT_EQ(description.initial[0].quantity, "force");
  EXPECT_TRUE(description.initial[0].conservative);
  EXPECT_EQ(description.initial[0].value.cols(), 2);
  EXPECT_FALSE(description.cannot_resume);
  EXPECT_TRUE(fmu.can_rewind());
  ASSERT_EQ(description.columns.size(), 3u);
  EXPECT_EQ(description.columns[0].name, "force");
  EXPECT_EQ(description.columns[0].unit, "newton");
  EXPECT_EQ(description.columns[1].name, "mass(1).x");
  EXPECT_EQ(description.lines.at(0), "oscillator.fmu   Oscillator, 2 points, 2 inputs, 1 output");
  EXPECT_EQ(description.lines.at(1), "points without a force: 2");
}

TEST(FmuAttachment, SaysWhatIsNotConnected) {
  FmuParameters p = oscillator_of(spring_and_mass());
  EXPECT_EQ(FmuAttachment(p, setup_of()).description().lines.size(), 1u);
  p.inputs.pop_back();
  const FmuAttachment fmu(p, setup_of());
  ASSERT_EQ(fmu.description().lines.size(), 2u);
  EXPECT_EQ(fmu.description().lines[1], "inputs that keep their start: end.w = 0");
}

TEST(FmuAttachment, GivesTheForceOfItsInputsAtTheStart) {
  strake::Setup setup = setup_of();
  MatrixXd u = MatrixXd::Zero(3, 1);
  u(1) = 0.25;
  setup.partner_initial[0].value = u;
  const FmuAttachment fmu(oscillator_of(spring_and_mass()), setup);
  EXPECT_DOUBLE_EQ(fmu.description().initial[0].value(1, 0), -stiffness * 0.25);
}

TEST(FmuAttachment, GetsTheAbsolutePathOfItsResources) {
  FmuAttachment fmu(oscillator_of(), setup_of());
  EXPECT_EQ(fmu.advance({0, 1e-3}, motion_to(fmu, 1e-3, 0, 0)).monitor.at("resources"), 1);
}

/// A step of the point by A leaves the mass in a free oscillation around it: x = A (1 - cos ωt).
TEST(FmuAttachment, FollowsAFreeOscillation) {
  constexpr double A = 0.01, h = 1e-3;
  FmuAttachment fmu(oscillator_of(spring_and_mass()), setup_of());
  fmu.advance({0, 1e-9}, motion_to(fmu, 1e-9, A, 0));  // a step in a window that is as good as none
  fmu.commit(false);
  double worst = 0;
  for (int n = 0; n < 400; ++n) {
    const double t = n * h;
    const Advanced answer =
        fmu.advance({t == 0 ? 1e-9 : t, t == 0 ? h - 1e-9 : h}, motion_to(fmu, t + h, A, 0));
    fmu.commit(false);
    worst = std::max(worst, std::abs(force_of(answer) + stiffness * A * std::cos(omega * (t + 0.5 * h))));
    EXPECT_NEAR(answer.monitor.at("mass(1).x"), A * (1 - std::cos(omega * (t + h))), 1e-7 * A);
  }
  EXPECT_LT(worst, 1e-6 * stiffness * A);
}

/// The point moves by A sin Ωt from rest; the mass by A/(1 - r²) (sin Ωt - r sin ωt), r = Ω/ω. Largest error
/// of the window-mean force, over its amplitude.
double error_with_windows_of(double h) {
  constexpr double A = 0.01, drive = 25;
  const double r = drive / omega, amplitude = stiffness * A;
  const auto integral = [&](double t) {  // of the force
    const double x = A / (1 - r * r) * (-std::cos(drive * t) / drive + r * std::cos(omega * t) / omega);
    return stiffness * (x + A * std::cos(drive * t) / drive);
  };
  FmuAttachment fmu(oscillator_of(spring_and_mass()), setup_of());
  double worst = 0;
  for (int n = 0; n * h < 0.3; ++n) {
    const double t = n * h, end = t + h;
    const Advanced answer = fmu.advance(
        {t, h}, motion_to(fmu, end, A * std::sin(drive * end), A * drive * std::cos(drive * end)));
    fmu.commit(false);
    worst = std::max(worst, std::abs(force_of(answer) - (integral(end) - integral(t)) / h) / amplitude);
  }
  return worst;
}

TEST(FmuAttachment, IsOfSecondOrderInTheWindow) {
  const double coarse = error_with_windows_of(4e-3), fine = error_with_windows_of(2e-3),
               finest = error_with_windows_of(1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.4);
  EXPECT_NEAR(fine / finest, 4, 0.4);
  EXPECT_LT(finest, 1e-3);
}

/// Displacement of a mass M on a spring K [kg] [N/m] to which the oscillator is attached, let go at `start`
/// [m]: q'' = -A q by the modes of A.
struct TwoMasses {
  static constexpr double M = 10, K = 9000, start = 0.02;
  Eigen::Matrix2d shape;
  Eigen::Vector2d weight, frequency;
  TwoMasses() {
    Eigen::Matrix2d A;
    A << (K + stiffness) / M, -stiffness / M, -stiffness / mass, stiffness / mass;
    const double mean = 0.5 * A.trace(), apart = std::sqrt(mean * mean - A.determinant());
    const Eigen::Vector2d squares(mean - apart, mean + apart);  // of the frequencies: A's eigenvalues
    shape << A(0, 1), A(0, 1), squares[0] - A(0, 0), squares[1] - A(0, 0);
    weight = shape.inverse() * Eigen::Vector2d(start, 0);
    frequency = squares.cwiseSqrt();
  }
  double displacement(double t) const {
    return shape.row(0) * (weight.array() * (frequency.array() * t).cos()).matrix();
  }
};

/// The same, coupled until the motion agrees: largest error of the displacement. The mass moves by the
/// trapezoidal rule with the window's mean force.
double error_of_a_coupled_run(double h) {
  constexpr double M = TwoMasses::M, K = TwoMasses::K, a = 0.25 / M;
  const TwoMasses exact;
  double u = TwoMasses::start, v = 0, worst = 0;
  strake::Setup setup = setup_of();
  setup.partner_initial[0].value = MatrixXd(Eigen::Vector3d(0, u, 0));
  FmuAttachment fmu(oscillator_of(spring_and_mass()), setup);
  for (int n = 0; n * h < 0.25; ++n) {
    double next = u + h * v, speed = v, before = 1;
    for (int iteration = 0; iteration < 60 && std::abs(next - before) > 1e-14; ++iteration) {
      if (iteration > 0) fmu.rewind();
      const double force = force_of(fmu.advance({n * h, h}, motion_to(fmu, (n + 1) * h, next, speed)));
      before = next;
      next = (u + h * v + a * h * h * (2 * force - K * u)) / (1 + a * h * h * K);
      speed = 2 * (next - u) / h - v;
    }
    u = next;
    v = speed;
    fmu.commit(false);
    worst = std::max(worst, std::abs(u - exact.displacement((n + 1) * h)));
  }
  return worst;
}

TEST(FmuAttachment, KeepsTheSecondOrderOfACoupledRun) {
  const double coarse = error_of_a_coupled_run(4e-3), fine = error_of_a_coupled_run(2e-3),
               finest = error_of_a_coupled_run(1e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.5);
  EXPECT_NEAR(fine / finest, 4, 0.5);
}

/// A mass that cannot move makes the FMU a spring: its force depends on the input at the same instant.
TEST(FmuAttachment, TakesDirectFeedThroughAtTheMeanOfTheWindow) {
  FmuAttachment fmu(oscillator_of({"k = 300", "m = 1e30"}), setup_of());
  double u = 0;
  for (int n = 0; n < 5; ++n) {
    const double next = u + 0.01 * (n + 1);
    const Advanced answer = fmu.advance({n * 1e-3, 1e-3}, motion_to(fmu, (n + 1) * 1e-3, next, 0));
    EXPECT_NEAR(force_of(answer), -300 * 0.5 * (u + next), 1e-12);
    u = next;
    fmu.commit(false);
  }
}

TEST(FmuAttachment, ConnectsComponentsOfSeveralPoints) {
  FmuParameters p = oscillator_of({"k = 10", "m = 1e30"});
  p.inputs = {"end.u = displacement.x.2"};
  p.outputs = {"force.z.3=F"};
  FmuAttachment fmu(p, setup_of(3, 3));
  Input input = motion_to(fmu, 1e-3, 9, 9);
  MatrixXd u = MatrixXd::Zero(3, 3);
  u(0, 1) = 0.5;
  input.samples[0].fields[0].value = u;
  const Advanced answer = fmu.advance({0, 1e-3}, input);
  MatrixXd expected = MatrixXd::Zero(3, 3);
  expected(2, 2) = -10 * 0.25;
  EXPECT_EQ((MatrixXd(answer.output[0].value) - expected).norm(), 0);
}

/// All that a window gives, to compare bit by bit.
std::vector<double> results(const Advanced& answer) {
  std::vector<double> all = {force_of(answer)};
  for (const auto& [name, value] : answer.monitor)
    if (!name.starts_with("seconds.")) all.push_back(value);
  return all;
}

TEST(FmuAttachment, IsTheSameAfterARewind) {
  FmuAttachment fmu(oscillator_of({"k = 4000", "m = 2.5", "c = 3"}), setup_of());
  fmu.advance({0, 1e-3}, motion_to(fmu, 1e-3, 0.01, 2));
  fmu.commit(false);
  const std::vector<double> once = results(fmu.advance({1e-3, 1e-3}, motion_to(fmu, 2e-3, 0.02, 3)));
  fmu.rewind();
  fmu.advance({1e-3, 0.5e-3}, motion_to(fmu, 1.5e-3, -0.5, 7));
  fmu.rewind();
  EXPECT_EQ(results(fmu.advance({1e-3, 1e-3}, motion_to(fmu, 2e-3, 0.02, 3))), once);
}

TEST(FmuAttachment, IsTheSameAfterAResume) {
  const ScratchFolder scratch;
  FmuParameters p = oscillator_of({"k = 4000", "m = 2.5", "c = 3"});
  FmuAttachment fmu(p, setup_of());
  for (int n = 0; n < 3; ++n) {
    fmu.advance({n * 1e-3, 1e-3}, motion_to(fmu, (n + 1) * 1e-3, 0.01 * n, 2));
    fmu.commit(false);
  }
  fmu.checkpoint(scratch.path());
  p.file = packed_fmu;
  FmuAttachment resumed(p, setup_of());
  resumed.resume(scratch.path());
  for (int n = 3; n < 6; ++n) {
    const Window window{n * 1e-3, 1e-3};
    EXPECT_EQ(results(resumed.advance(window, motion_to(fmu, window.t + 1e-3, -0.01, 1))),
              results(fmu.advance(window, motion_to(fmu, window.t + 1e-3, -0.01, 1))));
    resumed.rewind();  // to what was resumed, or committed since
    resumed.advance(window, motion_to(fmu, window.t + 1e-3, -0.01, 1));
    resumed.commit(false);
    fmu.commit(false);
  }
}

TEST(FmuAttachment, RefusesACheckpointThatDoesNotFit) {
  const ScratchFolder scratch;
  FmuAttachment fmu(oscillator_of(), setup_of());
  fmu.checkpoint(scratch.path());
  FmuAttachment three(oscillator_of(), setup_of(3));
  EXPECT_NE(error_of([&] { three.resume(scratch.path()); }, ExitCode::case_file).find("at 3 points"),
            std::string::npos);
  std::filesystem::remove(scratch / "damper.h5");
  EXPECT_NE(error_of([&] { fmu.resume(scratch.path()); }, ExitCode::case_file), "");
}

TEST(FmuAttachment, AsksForAShorterWindowWhereAStepIsDiscarded) {
  FmuAttachment fmu(oscillator_of({"fault = 3"}), setup_of());
  const Advanced refused = fmu.advance({0, 2e-3}, motion_to(fmu, 2e-3, 0.01, 0));
  EXPECT_TRUE(refused.retry_smaller_dt);
  EXPECT_DOUBLE_EQ(refused.dt_limit, 1e-3);
  EXPECT_EQ(refused.why, "the FMU discards fmi3DoStep: Discard (logStatusError): a step longer than 0.6 ms");
  fmu.rewind();
  const Advanced taken = fmu.advance({0, 1e-3}, motion_to(fmu, 1e-3, 0.01, 0));
  EXPECT_FALSE(taken.retry_smaller_dt);
  EXPECT_NE(force_of(taken), 0);
}

TEST(FmuAttachment, GoesOnAfterAWarning) {
  FmuAttachment fmu(oscillator_of({"fault = 6"}), setup_of());
  testing::internal::CaptureStdout();
  for (int n = 0; n < 3; ++n) {
    fmu.advance({n * 1e-3, 1e-3}, motion_to(fmu, (n + 1) * 1e-3, 0.01, 0));
    fmu.commit(false);
  }
  const std::string log = testing::internal::GetCapturedStdout();
  const std::size_t first = log.find("the spring is stretched");
  EXPECT_NE(first, std::string::npos) << log;
  EXPECT_EQ(log.find("the spring is stretched", first + 1), std::string::npos) << log;
}

}  // namespace fmu_attachment_test
}  // namespace strake
