#include "coupler/coupling/scheme.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace predictor_test {

using Eigen::MatrixXd;

/// u = c0 + c1 t + c2 t², on two points.
StructureSample polynomial(double t, double c1, double c2, bool with_velocity = false) {
  Motion motion = {MatrixXd::Constant(3, 2, 1 + c1 * t + c2 * t * t), {}};
  if (with_velocity) motion.velocity = MatrixXd::Constant(3, 2, c1 + 2 * c2 * t);
  return {t, motion, {}};
}

const Values& displacement(const StructureSample& sample) {
  return sample.motion.value().displacement;
}

const Values& velocity(const StructureSample& sample) {
  return sample.motion.value().velocity;
}

StructureSamples at(const std::vector<double>& times, double c1, double c2, bool with_velocity = false,
                    Predictor kind = Predictor::quadratic) {
  StructureSamples history;
  for (const double t : times) remember(history, polynomial(t, c1, c2, with_velocity), kind);
  return history;
}

double error(const StructureSample& guess, const StructureSample& exact) {
  return (displacement(guess) - displacement(exact)).cwiseAbs().maxCoeff();
}

TEST(Predictor, FollowsAPolynomialOfItsDegreeThroughWindowsOfAnyLength) {
  const std::vector<double> times = {0, 0.1, 0.13, 0.2};
  EXPECT_LE(error(predict(Predictor::linear, at(times, -6, 0), 0.5), polynomial(0.5, -6, 0)), 1e-14);
  EXPECT_LE(error(predict(Predictor::quadratic, at(times, -6, 20), 0.5), polynomial(0.5, -6, 20)), 1e-13);
  EXPECT_GT(error(predict(Predictor::linear, at(times, -6, 20), 0.5), polynomial(0.5, -6, 20)), 1);
  EXPECT_EQ(displacement(predict(Predictor::constant, at(times, -6, 20), 0.5)),
            displacement(polynomial(0.2, -6, 20)));
}

TEST(Predictor, MovesOnWithTheInitialVelocityInTheFirstWindow) {
  for (const Predictor kind : {Predictor::linear, Predictor::quadratic}) {
    const StructureSample guess = predict(kind, at({0}, -6, 0, true), 0.1);
    EXPECT_LE(error(guess, polynomial(0.1, -6, 0)), 1e-15);
    EXPECT_LE((velocity(guess).array() + 6).abs().maxCoeff(), 1e-13);
  }
  EXPECT_EQ(displacement(predict(Predictor::quadratic, at({0}, -6, 0), 0.1)),
            displacement(polynomial(0, -6, 0)));
}

TEST(Predictor, GivesTheVelocityOfConstantAccelerationOverTheWindow) {
  const StructureSample guess = predict(Predictor::quadratic, at({0, 0.1, 0.2}, -6, 20, true), 0.3);
  EXPECT_LE((velocity(guess) - velocity(polynomial(0.3, -6, 20, true))).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Predictor, ExtrapolatesEachFieldByItself) {
  Samples history;
  for (const double t : {0.0, 0.1, 0.2})
    remember(history,
             Sample{t,
                    {{"area", "m^2", false, MatrixXd::Constant(1, 2, 1 + t * t)},
                     {"velocity", "m/s", false, MatrixXd::Constant(1, 2, 2 - t * t)}}},
             Predictor::quadratic);
  const Sample guess = predict(Predictor::quadratic, history, 0.3);
  EXPECT_NEAR(guess.fields[0].value(0, 1), 1.09, 1e-14);
  EXPECT_NEAR(guess.fields[1].value(0, 1), 1.91, 1e-14);  // no displacement that it would belong to
}

TEST(Predictor, RemembersAsManyWindowsAsItTakes) {
  const std::vector<double> times = {0, 1, 2, 3, 4};
  for (const Predictor kind : {Predictor::constant, Predictor::linear, Predictor::quadratic}) {
    const StructureSamples few = at(times, 1, 2, true, kind), more = at(times, 1, 2, true);
    ASSERT_EQ(few.size(), static_cast<std::size_t>(kind) + 1);
    EXPECT_EQ(few.back().time, 4);
    const StructureSample guess = predict(kind, few, 5), same = predict(kind, more, 5);
    EXPECT_EQ(displacement(guess), displacement(same));
    EXPECT_EQ(velocity(guess), velocity(same));
  }
}

TEST(Predictor, IsKnownByName) {
  EXPECT_EQ(predictor_kind("quadratic"), Predictor::quadratic);
  EXPECT_THROW(predictor_kind("cubic"), Error);
}

}  // namespace predictor_test
}  // namespace strake
