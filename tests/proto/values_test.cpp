#include "proto/values.hpp"

#include "proto/interface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace strake {
namespace values_test {

using Eigen::MatrixXd;

TEST(Values, ReadLikeAMatrix) {
  const MatrixXd m = MatrixXd::Random(3, 5);
  const Values v = m;
  EXPECT_EQ(v, m);
  EXPECT_EQ(v(2, 3), m(2, 3));
  EXPECT_EQ(MatrixXd(2 * v.transpose()), MatrixXd(2 * m.transpose()));
  EXPECT_EQ(v.rowwise().sum(), m.rowwise().sum());
  EXPECT_EQ(Points(v), Points(m));
  EXPECT_EQ(Values().size(), 0);
}

TEST(Values, TakeOverAMatrixWithoutACopy) {
  MatrixXd m = MatrixXd::Random(3, 5);
  const double* numbers = m.data();
  EXPECT_EQ(Values(std::move(m)).data(), numbers);
}

TEST(Values, CopiesShareTheNumbersUntilOneIsChanged) {
  const MatrixXd m = MatrixXd::Random(3, 5);
  Values a = m, b = a;
  EXPECT_EQ(a.data(), b.data());
  b.edit()(1, 2) = 7;
  EXPECT_EQ(a, m);
  EXPECT_EQ(b(1, 2), 7);
  const double* own = b.data();
  b.edit() *= 2;
  EXPECT_EQ(b.data(), own) << "nobody else has them";
  EXPECT_EQ(b(1, 2), 14);
}

TEST(Values, MoveLeavesNothingBehind) {
  Values a = MatrixXd::Ones(3, 5);
  a.mark_finite();
  Values b = std::move(a);
  EXPECT_EQ(a.size(), 0);
  EXPECT_FALSE(a.known_finite());
  EXPECT_TRUE(b.known_finite());
  Values& same = b;
  b = std::move(same);
  EXPECT_EQ(b, MatrixXd::Ones(3, 5));
  b = Values(b);
  EXPECT_EQ(b, MatrixXd::Ones(3, 5));
}

TEST(Values, LentNumbersLiveAsLongAsSomebodyReadsThem) {
  auto message = std::make_shared<std::vector<double>>(std::vector<double>{1, 2, 3, 4, 5, 6});
  const std::weak_ptr<std::vector<double>> watched = message;
  Values a = Values::lent(message->data(), 3, 2, message);
  const double* numbers = message->data();
  message.reset();
  Values b = a;
  EXPECT_EQ(b.data(), numbers);
  b.edit()(0, 0) = 9;  // lent numbers are never changed, even without another reader
  EXPECT_EQ(a(0, 0), 1);
  a.edit()(0, 0) = 8;
  EXPECT_NE(a.data(), numbers);
  EXPECT_TRUE(watched.expired());
  EXPECT_EQ(a(2, 1), 6);
}

TEST(Values, WhatIsChangedIsLookedAtAgain) {
  Values a = MatrixXd::Ones(3, 2);
  EXPECT_FALSE(a.known_finite());
  a.mark_finite();
  const Values copy = a;
  EXPECT_TRUE(copy.known_finite());
  a.edit()(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(a.known_finite());
  EXPECT_FALSE(all_finite(a));
  EXPECT_TRUE(all_finite(copy));
}

TEST(Values, ALookFindsWhatIsNotFiniteWhereverItStands) {
  const double infinity = std::numeric_limits<double>::infinity(), none = std::nan("");
  for (const Eigen::Index components : {1, 3})
    for (const Eigen::Index n : {1, 100, 1000, 1003})
      for (const Eigen::Index bad : {Eigen::Index{0}, n / 2, n - 1})
        for (const double value : {infinity, -infinity, none}) {
          MatrixXd m = MatrixXd::Random(components, n);
          EXPECT_TRUE(Values(m).check_finite());
          m(components - 1, bad) = value;
          Values v = m;
          EXPECT_FALSE(v.check_finite());
          EXPECT_FALSE(v.known_finite());
          m(0, n - 1 - bad) = -value;  // whose sum with the other is none
          EXPECT_FALSE(Values(m).check_finite());
        }
  Values large = MatrixXd::Constant(3, 1000, 1e308);
  EXPECT_TRUE(large.check_finite()) << "though the sum is not";
  EXPECT_EQ(large.sum_over_points(), Eigen::Vector3d::Constant(infinity));
}

TEST(Values, TheSumOverThePointsIsThatOfTheNumbersAsTheyAre) {
  for (const Eigen::Index n : {0, 1, 41, 512, 513, 1000, 1007}) {
    const MatrixXd m = MatrixXd::Random(3, n);
    Values v = m;
    const Eigen::Vector3d sum = v.sum_over_points();
    EXPECT_LE((sum - m.rowwise().sum()).cwiseAbs().maxCoeff(), 1e-15 * static_cast<double>(n));
    EXPECT_TRUE(v.check_finite());
    EXPECT_EQ(v.sum_over_points(), sum) << "looked at or not";
    const Values copy = v;
    EXPECT_EQ(copy.sum_over_points(), sum);
    if (n == 0) continue;
    v.edit().col(n - 1).setConstant(7);
    EXPECT_NEAR(v.sum_over_points().x(), sum.x() - m(0, n - 1) + 7, 1e-12);
  }
  EXPECT_FALSE(std::signbit(Values(MatrixXd::Constant(3, 2, -0.0)).sum_over_points().x()));
}

}  // namespace values_test
}  // namespace strake
