#include "proto/values.hpp"

#include "proto/interface.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace strake {
namespace {

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
  b.edit()(0, 0) = 9;  // what was lent is never changed, though nobody else reads it
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

}  // namespace
}  // namespace strake
