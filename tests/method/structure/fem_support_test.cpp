// Finite elements on supports that move, and bodies that start in motion.
#include "structure/fem/solver.hpp"
#include "tests/method/structure/moving_supports.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

namespace strake::structure::fem {
namespace fem_support_test {

TEST(FemFrame, ADropKeepsMomentumAndEnergy) {
  for (const MaterialModel model : {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff})
    for (const Support support : {Support::clamped, Support::pinned}) {
      Parameters p = dropped_plate();
      p.material.model = model;
      p.plate.left = p.plate.right = support;
      expect_a_drop_to_keep_momentum_and_energy<FemSolver<2>>(p, 1e-9);
    }
}

// With rho_inf < 1 the result is the same except for the first step. Its load comes at once: a tenth of dt
// later or earlier.
TEST(FemFrame, ADropWithNumericalDampingFallsAlike) {
  Parameters p = dropped_plate();
  FemSolver<2> exact(p);
  p.fem.rho_infinity = 0.8;
  FemSolver<2> damped(p);
  const Load load = upward(exact.interface(), 3e5);
  for (int k = 0; k < 100; ++k) {
    exact.advance(1e-5 * k, 1e-5, load);
    damped.advance(1e-5 * k, 1e-5, load);
  }
  EXPECT_NEAR(damped.support_displacement({0, 0.01, 0})->y() / exact.support_displacement({0, 0.01, 0})->y(),
              1, 5e-3);
  EXPECT_NEAR(damped.momentum().y() / exact.momentum().y(), 1, 1e-2);
}

TEST(FemFrame, AnAccelerationOfTheSupportsBendsLikeWeight) {
  Parameters p = paper_plate(4);
  p.fem.refinement = 1;
  expect_acceleration_to_bend_like_weight<FemSolver<2>>(p);
}

TEST(FemFrame, AClampThatTurnsStretchesAStrip) {
  Parameters p = paper_plate(2);
  p.fem.refinement = 1;
  expect_a_turning_clamp_to_stretch_the_strip<FemSolver<2>>(p, 1e-8, 0.02);
}

TEST(FemFrame, AFreeBodyFalls) {
  Parameters p = paper_plate(4);
  p.fem.refinement = 1;
  expect_a_free_body_to_fall<FemSolver<2>>(p);
}

TEST(FemFrame, CheckpointsAndRewindsAreBitEqual) {
  expect_checkpoints_and_rewinds_to_be_bit_equal<FemSolver<2>>(dropped_plate());
}

// cases/VALIDATION.md, "Elastic plate: first bending", dry. The references are of Euler-Bernoulli's beam.
// Shear takes 1.6 % of the plate's stiffness and shifts the ripple of modes 3 and 5. A strip of a sixteenth
// of the thickness is close to that beam, with sixteen times its deflection and time. With pinned ends there
// are two equal peaks, at 0.691 and 0.931 ms.
TEST(FemStart, AStoppedStripBendsAsFarAsTheBeamWithinOnePercent) {
  constexpr double slender = 16;
  for (const auto& [support, peak_at, time_at] :
       {std::tuple{Support::clamped, 0.3049e-3, 0.444e-3}, {Support::pinned, 0.6571e-3, 0.931e-3}}) {
    Parameters p = paper_plate(4);
    p.plate.thickness = 0.02 / slender;
    p.plate.left = p.plate.right = support;
    p.fem.refinement = 1;
    p.material.model = MaterialModel::linear;
    p.initial.value = {0, -1, 0};
    FemSolver<2> solver(p);
    double peak = 0, time = 0;
    const double dt = slender * time_at / 300;  // modes 5 to 9 make the last 2 % of the peak
    for (int k = 0; k * dt < 1.2 * slender * time_at; ++k) {
      solver.advance(k * dt, dt, {});
      const double w = -solver.displacement_at({0, 0.01 / slender, 0}).y();
      if (w > peak) {
        peak = w;
        time = (k + 1) * dt;
      }
    }
    const std::string name = support == Support::clamped ? "cc" : "pp";
    RecordProperty(name + "_peak", std::to_string(peak / (slender * peak_at)));
    RecordProperty(name + "_time", std::to_string(time / (slender * time_at)));
    EXPECT_NEAR(peak / (slender * peak_at), 1, 0.01) << name;
    EXPECT_LT(time / (slender * time_at), 1.03) << name;  // the peak is flat
    EXPECT_GT(time / (slender * (support == Support::clamped ? time_at : 0.691e-3)), 0.97) << name;
  }
}

// A velocity over x and one of a part: what a file and [[structure.box]] give.
TEST(FemStart, ProfilesAndPartsAddToTheVelocityOfTheBody) {
  Parameters p = paper_plate(4);
  p.plate.left = p.plate.right = Support::free;
  p.fem.refinement = 1;
  p.initial.value = {1, 0, 0};
  p.initial.of_part = {{0, 0, 0}};
  p.initial.profile.emplace(
      std::vector<double>{-0.2, 0.0, 0.2},
      std::array{MotionColumn::absent, MotionColumn::place, MotionColumn::absent, MotionColumn::absent},
      std::array<std::vector<double>, 4>{{{}, {4, 0, 4}, {}, {}}});
  FemSolver<2> solver(p);
  EXPECT_NEAR(solver.velocity_at({0.1, 0.01, 0}).y(), 1, 1e-12) << "100 x² by the spline";
  EXPECT_NEAR(solver.velocity_at({0.1, 0.01, 0}).x(), 1, 1e-12);
}

}  // namespace fem_support_test
}  // namespace strake::structure::fem
