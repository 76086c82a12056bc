#include "coupler/predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/error.hpp"

namespace strake {
namespace {

using Eigen::MatrixXd;

/// u = c0 + c1 t + c2 t², on two points.
Motion polynomial(double t, double c1, double c2, bool with_velocity = false) {
  Motion motion = {t, MatrixXd::Constant(3, 2, 1 + c1 * t + c2 * t * t), {}};
  if (with_velocity) motion.velocity = MatrixXd::Constant(3, 2, c1 + 2 * c2 * t);
  return motion;
}

MotionHistory at(const std::vector<double>& times, double c1, double c2, bool with_velocity = false) {
  MotionHistory history;
  for (const double t : times) remember(history, polynomial(t, c1, c2, with_velocity));
  return history;
}

double error(const Motion& guess, const Motion& exact) {
  return (guess.displacement - exact.displacement).cwiseAbs().maxCoeff();
}

TEST(Predictor, FollowsAPolynomialOfItsDegreeThroughWindowsOfAnyLength) {
  const std::vector<double> times = {0, 0.1, 0.13, 0.2};
  EXPECT_LE(error(predict(Predictor::linear, at(times, -6, 0), 0.5), polynomial(0.5, -6, 0)), 1e-14);
  EXPECT_LE(error(predict(Predictor::quadratic, at(times, -6, 20), 0.5), polynomial(0.5, -6, 20)), 1e-13);
  EXPECT_GT(error(predict(Predictor::linear, at(times, -6, 20), 0.5), polynomial(0.5, -6, 20)), 1);
  EXPECT_EQ(predict(Predictor::constant, at(times, -6, 20), 0.5).displacement,
            polynomial(0.2, -6, 20).displacement);
}

TEST(Predictor, MovesOnWithTheInitialVelocityInTheFirstWindow) {
  for (const Predictor kind : {Predictor::linear, Predictor::quadratic}) {
    const Motion guess = predict(kind, at({0}, -6, 0, true), 0.1);
    EXPECT_LE(error(guess, polynomial(0.1, -6, 0)), 1e-15);
    EXPECT_LE((guess.velocity.array() + 6).abs().maxCoeff(), 1e-13);
  }
  EXPECT_EQ(predict(Predictor::quadratic, at({0}, -6, 0), 0.1).displacement,
            polynomial(0, -6, 0).displacement);
}

TEST(Predictor, GivesTheVelocityOfConstantAccelerationOverTheWindow) {
  const Motion guess = predict(Predictor::quadratic, at({0, 0.1, 0.2}, -6, 20, true), 0.3);
  EXPECT_LE((guess.velocity - polynomial(0.3, -6, 20, true).velocity).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Predictor, RemembersThreeWindows) {
  const MotionHistory history = at({0, 1, 2, 3, 4}, 1, 0);
  ASSERT_EQ(history.size(), 3u);
  EXPECT_EQ(history.front().time, 2);
}

TEST(Predictor, IsKnownByName) {
  EXPECT_EQ(predictor_kind("quadratic"), Predictor::quadratic);
  EXPECT_THROW(predictor_kind("cubic"), Error);
}

}  // namespace
}  // namespace strake
