#include "fluid/least_squares/film.hpp"

#include "fluid/least_squares/constants.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace strake::fluid {
namespace film_test {

/// B of a lattice's particle with `below` rows under it and `above` rows over it, weights of the radius 2.1.
template <int dim>
Eigen::Matrix<double, dim, dim> lattice(int below, int above) {
  Eigen::Matrix<double, dim, dim> b = Eigen::Matrix<double, dim, dim>::Zero();
  const int wide = dim == 3 ? 2 : 0;
  for (int x = -2; x <= 2; ++x)
    for (int y = -below; y <= above; ++y)
      for (int z = -wide; z <= wide; ++z) {
        Eigen::Matrix<double, dim, 1> r;
        r[0] = x;
        r[1] = y;
        if constexpr (dim == 3) r[2] = z;
        const double length = r.norm();
        if (length > 0 && length < 2.1) b += (2.1 / length - 1) / (length * length) * r * r.transpose();
      }
  return b;
}

TEST(Film, WaterInsideAndInTheFirstRowOfALatticeIsNone) {
  EXPECT_EQ(film_share<2>(lattice<2>(2, 2)), 0);
  EXPECT_EQ(film_share<2>(lattice<2>(2, 0)), 0);
  EXPECT_EQ(film_share<3>(lattice<3>(2, 2)), 0);
  EXPECT_EQ(film_share<3>(lattice<3>(2, 0)), 0);
}

TEST(Film, ARowALayerADropAndAPairAreAWhole) {
  EXPECT_EQ(film_share<2>(lattice<2>(0, 0)), 1);
  EXPECT_EQ(film_share<3>(lattice<3>(0, 0)), 1);
  Eigen::Matrix2d pair = Eigen::Matrix2d::Zero();
  pair(0, 0) = 1;
  EXPECT_EQ(film_share<2>(pair), 1);
  EXPECT_EQ(film_share<2>(Eigen::Matrix2d::Zero()), 0) << "no neighbour, no film: nothing to bound it by";
}

TEST(Film, TheShareRisesLinearlyBetweenTheTwoRatiosWhateverTheDirection) {
  const LeastSquaresConstants tuned;
  const Eigen::Rotation2Dd turn(0.7);
  for (const double part : {0.0, 0.25, 0.5, 1.0}) {
    const double ratio = tuned.film_begins - part * (tuned.film_begins - tuned.film_counts);
    const Eigen::Matrix2d b = turn.toRotationMatrix() * Eigen::Vector2d(3, 3 * ratio).asDiagonal() *
                              turn.toRotationMatrix().transpose();
    EXPECT_NEAR(film_share<2>(b), part, 1e-9);
    // In space at the middle eigenvalue where det/(tr/3)^3 is largest, and at both ends.
    for (const double middle : {ratio, 0.5 * (1 + ratio), 1.0})
      EXPECT_NEAR(film_share<3>(Eigen::Vector3d(1, ratio, middle).asDiagonal().toDenseMatrix()), part, 1e-9);
  }
}

}  // namespace film_test
}  // namespace strake::fluid
