#include "fluid/pressure_solver/multilevel.hpp"

#include "fluid/mps/pressure_equation.hpp"
#include "tests/algebra/factors.hpp"
#include "tests/fluid/direct_pressure.hpp"
#include "tests/fluid/pressure_cases.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <limits>

namespace strake::fluid {
namespace {

constexpr double tolerance = 1e-10;

Scheme scheme_of(Preconditioner preconditioner) {
  Scheme scheme;
  scheme.preconditioner = preconditioner;
  scheme.pressure_tolerance = tolerance;
  return scheme;
}

template <int dim>
PressureSolution solve(const PressureSystem& system, const PressureCase<dim>& c, const Scheme& scheme) {
  Scheme with_radius = scheme;
  with_radius.radius_laplacian = c.radius;
  return PoissonSolver<dim>(c.radius).solve(system, c.position, Eigen::VectorXd::Zero(system.size()),
                                            with_radius);
}

/// Iterations of the multilevel solve, after its solution was found equal to the direct solver's. Residuals
/// of 1e-10 times condition numbers up to 1e5 bound the error; it is far smaller, for the noise is rough.
template <int dim>
int check(const PressureCase<dim>& c) {
  PressureSystem system = c.assemble();
  close_sealed_blocks(system);
  const Eigen::VectorXd direct = direct_pressure(system);
  const PressureSolution grids = solve(system, c, scheme_of(Preconditioner::multilevel));
  EXPECT_LT(pressure_residual(system, grids.pressure), 2 * tolerance);
  EXPECT_LT((grids.pressure - direct).norm(), 1e-7 * direct.norm());
  return grids.iterations;
}

/// Rows of `length` particles over one another, moved by up to a tenth of the spacing.
PressureCase<2> film(int length, int rows) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> shift(-0.1, 0.1);
  Vectors<2> x(2, length * rows);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    x.col(i) << static_cast<double>(i % length) + shift(generator),
        static_cast<double>(i / length) + shift(generator);
  return PressureCase<2>(x);
}

TEST(Multilevel, IterationsOfATankDoNotGrowWithItsSize) {
  for (const double radius : {2.1, 3.1}) {
    const int small = check(tank<2>(30, radius)), large = check(tank<2>(120, radius));
    EXPECT_LE(small, 12);
    EXPECT_LE(large, small + 2) << "radius " << radius;
  }
}

TEST(Multilevel, IterationsOfATankInThreeDimensionsDoNotGrowWithItsSize) {
  const int small = check(tank<3>(8, 2.1)), large = check(tank<3>(18, 2.1));
  EXPECT_LE(small, 12);
  EXPECT_LE(large, small + 2);
}

TEST(Multilevel, UnknownsMayStandInAnyOrder) {
  const PressureCase<2> ordered = tank<2>(40, 2.1);
  PressureCase<2> c(shuffled<2>(ordered.position));
  c.radius = ordered.radius;
  for (Eigen::Index i = 0; i < c.position.cols(); ++i)
    if (c.position(1, i) > 19) c.row[static_cast<std::size_t>(i)] = Row::zero;
  EXPECT_LE(check(c), 12);
}

TEST(Multilevel, LongFilmsOfFewRowsAreSolvedAsQuickly) {
  for (const int rows : {1, 2, 3}) {
    PressureCase<2> c = film(500, rows);
    for (const double radius : {2.1, 3.1}) {
      c.radius = radius;
      EXPECT_LE(check(c), 18) << rows << " rows, radius " << radius;
    }
  }
}

TEST(Multilevel, DropsAndBlobsThatDoNotTouchAreSolvedTogether) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> number(0, 1);
  std::vector<Vector<2>> place;
  std::vector<Row> row;
  for (int blob = 0; blob < 120; ++blob) {
    const Vector<2> corner(300 * number(generator), 300 * number(generator));
    const int side = 1 + static_cast<int>(6 * number(generator));
    for (int i = 0; i < side * side; ++i) {
      place.push_back(corner + Vector<2>(i % side, i / side));
      row.push_back(number(generator) < 0.2 ? Row::zero : Row::unknown);
    }
  }
  Vectors<2> x(2, static_cast<Eigen::Index>(place.size()));
  for (std::size_t i = 0; i < place.size(); ++i) x.col(static_cast<Eigen::Index>(i)) = place[i];
  PressureCase<2> c(x);
  c.row = row;
  c.radius = 2.1;
  EXPECT_LE(check(c), 30);
}

TEST(Multilevel, WaterOnBothSidesOfAPlateKeepsItsOwnPressure) {
  PressureCase<2> c = tank<2>(60, 3.1);
  c.tag.assign(static_cast<std::size_t>(c.position.cols()), PairTag::asked);
  c.keep = [&c](std::int32_t i, std::int32_t j) {  // nothing sees through the plate x = 0.3 below y = 10
    const bool below = c.position(1, i) + c.position(1, j) < 20;
    return !below || (c.position(0, i) < 0.3) == (c.position(0, j) < 0.3);
  };
  EXPECT_LE(check(c), 16);
}

TEST(Multilevel, SealedWaterAndWaterOpenToTheAirStandSideBySide) {
  PressureCase<2> c = tank<2>(50, 2.1);
  c.tag.assign(static_cast<std::size_t>(c.position.cols()), PairTag::asked);
  c.keep = [&c](std::int32_t i, std::int32_t j) {
    return (c.position(0, i) < 0.3) == (c.position(0, j) < 0.3);
  };
  for (std::size_t i = 0; i < c.row.size(); ++i)
    if (c.position(0, static_cast<Eigen::Index>(i)) > 0.3) c.row[i] = Row::unknown;
  EXPECT_LE(check(c), 14);
}

TEST(Multilevel, FarFlyersDoNotSpoilTheGrid) {
  PressureCase<2> c = tank<2>(40, 3.1);
  c.position.col(5) << 1e6, -2e5;
  c.position.col(700) << -1e9, 4;
  EXPECT_LE(check(c), 14);
}

TEST(Multilevel, PeriodicWaterIsSolvedOverItsSeam) {
  PressureCase<2> c = tank<2>(48, 2.1);
  c.space = Periodic<2>(Vector<2>(48, 0));
  EXPECT_LE(check(c), 20);
  c.space = Periodic<2>(Vector<2>(48, 48));
  for (Row& row : c.row) row = Row::unknown;
  EXPECT_LE(check(c), 24);
}

TEST(Multilevel, StronglyCompressibleWaterIsSolvedInFewIterations) {
  PressureCase<2> c = tank<2>(40, 3.1);
  c.sound_speed = 300;  // c Δt/l0 = 0.3
  EXPECT_LE(check(c), 12);
}

TEST(Multilevel, IsSymmetricAndPositiveDefinite) {
  for (PressureCase<2> c : {tank<2>(14, 2.1), film(60, 1), film(40, 2)}) {
    PressureSystem system = c.assemble();
    close_sealed_blocks(system);
    Multilevel<2> multilevel;
    multilevel.build(system, c.position, c.radius, c.radius, 1);
    const auto n = system.size();
    Eigen::MatrixXd m(n, n);
    for (std::int64_t j = 0; j < n; ++j) {
      for (std::int64_t k = 0; k < n; ++k) {
        multilevel.right()[k] = k == j ? 1.0f : 0.0f;
        multilevel.swept()[k] = multilevel.inverse()[k] * multilevel.right()[k];
      }
      multilevel.apply(system, Team{});
      for (std::int64_t k = 0; k < n; ++k) m(k, j) = multilevel.solution()[k];
    }
    const double round_off = 1e-5;  // single precision, some tens of sums in a row
    EXPECT_LT((m - m.transpose()).norm(), round_off * m.norm());
    EXPECT_TRUE(is_positive_definite(0.5 * (m + m.transpose())));
  }
}

TEST(Multilevel, GivesTheSameBitsOnAnyNumberOfThreads) {
  const PressureCase<2> c = tank<2>(150, 2.1);
  const PressureSystem system = c.assemble();
  const int before = omp_get_max_threads();
  std::array<Eigen::VectorXd, 3> pressure;
  for (int threads = 1; threads <= 3; ++threads) {
    omp_set_num_threads(threads);
    pressure[static_cast<std::size_t>(threads - 1)] =
        solve(system, c, scheme_of(Preconditioner::multilevel)).pressure;
  }
  omp_set_num_threads(before);
  EXPECT_TRUE((pressure[0].array() == pressure[1].array()).all());
  EXPECT_TRUE((pressure[0].array() == pressure[2].array()).all());
}

TEST(Multilevel, ASolverThatServedAnotherSystemGivesTheSameBits) {
  const PressureCase<2> c = tank<2>(40, 2.1), other = film(300, 2);
  const PressureSystem system = c.assemble();
  PressureSystem before = other.assemble();
  close_sealed_blocks(before);
  const Scheme scheme = scheme_of(Preconditioner::multilevel);
  PoissonSolver<2> used(c.radius), fresh(c.radius);
  used.solve(before, other.position, Eigen::VectorXd::Zero(before.size()), scheme);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(system.size());
  EXPECT_TRUE((used.solve(system, c.position, zero, scheme).pressure.array() ==
               fresh.solve(system, c.position, zero, scheme).pressure.array())
                  .all());
}

TEST(Multilevel, WhatIsNoNumberEndsTheSolveAndShowsInTheResidual) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const PressureCase<2> c = tank<2>(40, 2.1);
  const Scheme scheme = scheme_of(Preconditioner::multilevel);
  PressureSystem right = c.assemble();
  right.right[17] = nan;
  EXPECT_FALSE(solve(right, c, scheme).residual <= tolerance);
  PressureSystem matrix = c.assemble();
  matrix.own.value[static_cast<std::size_t>(matrix.start[100])] = nan;
  EXPECT_FALSE(solve(matrix, c, scheme).residual <= tolerance);
  PressureCase<2> places = c;
  const PressureSystem good = c.assemble();
  places.position(0, 100) = nan;  // of the preconditioner alone: worse, but right
  const PressureSolution solution = solve(good, places, scheme);
  EXPECT_LE(solution.residual, tolerance);
}

TEST(PressureChoice, TakesTheDiagonalWhereCompressibilityHoldsIt) {
  Scheme scheme;
  scheme.preconditioner = Preconditioner::automatic;
  PressureCase<2> c = tank<2>(40, 3.1);
  EXPECT_EQ(choose_pressure_solver(c.assemble(), scheme).preconditioner, Preconditioner::multilevel);
  c.sound_speed = 300;  // c Δt/l0 = 0.3
  const PressureSystem stiff = c.assemble();
  const PressureChoice choice = choose_pressure_solver(stiff, scheme);
  EXPECT_EQ(choice.preconditioner, Preconditioner::jacobi);
  EXPECT_LE(solve(stiff, c, scheme).iterations, choice.jacobi_iterations);
  c.sound_speed = 20000;  // c Δt/l0 = 20
  EXPECT_EQ(choose_pressure_solver(c.assemble(), scheme).preconditioner, Preconditioner::multilevel);
}

}  // namespace
}  // namespace strake::fluid
