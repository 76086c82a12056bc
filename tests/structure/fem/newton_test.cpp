#include "structure/fem/newton.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure::fem {
namespace newton_test {

/// r(x) = −f(x) of one unknown, with the tangent f' computed when the method requests one.
struct Scalar {
  double (*f)(double), (*slope)(double);
  double tangent_at = 0;
  int tangents = 0;
  Equilibrium equilibrium() {
    const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
    return {
        .residual = [this, one](const Eigen::VectorXd& x) -> Equilibrium::Residual {
          return {.value = one(-f(x[0])), .scale = 1};
        },
        .correction = [this](const Eigen::VectorXd& r) -> Eigen::VectorXd { return r / slope(tangent_at); },
        .refresh =
            [this](const Eigen::VectorXd& x) {
              tangent_at = x[0];
              ++tangents;
              return slope(tangent_at) != 0;
            }};
  }
};

const Eigen::VectorXd from(double x) {
  return Eigen::VectorXd::Constant(1, x);
}

// From x = 3 Newton's full steps swing further and further: 3, −9.5, 124, …
TEST(Newton, SearchesAlongTheLineWhereTheFullStepRunsAway) {
  Scalar arc{[](double x) { return std::atan(x); }, [](double x) { return 1 / (1 + x * x); }, 3};
  const NewtonResult result = solve(arc.equilibrium(), from(3), 1e-12);
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x[0], 0, 1e-12);
  EXPECT_LT(result.iterations, 12);
  EXPECT_TRUE(result.refreshed);
}

TEST(Newton, KeepsATangentThatServes) {
  Scalar line{[](double x) { return 2 * x - 3; }, [](double) { return 2.1; }};
  const NewtonResult result = solve(line.equilibrium(), from(0), 1e-10);
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x[0], 1.5, 1e-9);
  EXPECT_EQ(line.tangents, 0);
}

TEST(Newton, SaysThatItFailedWhereThereIsNoEquilibrium) {
  Scalar none{[](double x) { return 1 + x * x; }, [](double x) { return 2 * x; }, 1};
  EXPECT_FALSE(solve(none.equilibrium(), from(1), 1e-10).converged);
}

}  // namespace newton_test
}  // namespace strake::structure::fem
