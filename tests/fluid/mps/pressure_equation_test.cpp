#include "fluid/mps/pressure_equation.hpp"

#include "fluid/pressure_solver/poisson_solver.hpp"
#include "tests/fluid/direct_pressure.hpp"
#include "tests/fluid/lattice.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <limits>

namespace strake::fluid {
namespace pressure_equation_test {

constexpr double infinity = std::numeric_limits<double>::infinity(), spacing = 0.01;

/// A disordered block of water without walls: its outer faces have no flux, or P = 0 where `open`.
struct Block {
  Vectors<2> position;
  NeighbourSearch<2> search{3.1 * spacing, 0};
  const Neighbours* rows;
  LatticeConstants lattice = lattice_constants<2>(3.1, spacing);
  std::vector<Row> row;
  Eigen::VectorXd divergence, deviation, old_pressure, density;
  Scheme scheme;
  double sound_speed = infinity, dt = 1e-5;

  explicit Block(int side, bool open) : position(block<2>(side, spacing, 0.1)) {
    rows = &search.update(position);
    const auto n = position.cols();
    row.assign(static_cast<std::size_t>(n), Row::unknown);
    if (open)
      for (Eigen::Index i = 0; i < n; ++i)
        if (i / side == side - 1) row[static_cast<std::size_t>(i)] = Row::zero;
    divergence = 10 * Eigen::VectorXd::Random(n);
    deviation = old_pressure = Eigen::VectorXd::Zero(n);
    density.setConstant(n, 1000);
    scheme.source = Source::divergence;
    scheme.pressure_tolerance = 1e-12;
  }
  PressureSystem assemble() const {
    PressureSystem system;
    assemble_pressure<2>(*rows, {row, divergence, deviation, old_pressure, density, 1000, sound_speed, dt},
                         scheme, lattice, system);
    return system;
  }
};

PressureSolution solve(const PressureSystem& system, const Block& water) {
  return PoissonSolver<2>(water.lattice.radius)
      .solve(system, water.position, Eigen::VectorXd::Zero(system.size()), water.scheme);
}

double entry(const PressureSystem& system, std::int64_t i, std::int64_t j) {
  for (std::int64_t e = system.start[static_cast<std::size_t>(i)];
       e < system.stop[static_cast<std::size_t>(i)]; ++e)
    if (system.column[static_cast<std::size_t>(e)] == j) return system.value[static_cast<std::size_t>(e)];
  return 0;
}

TEST(Pressure, MatrixIsSymmetricToTheLastBitAlsoWithTwoDensities) {
  Block water(12, true);
  for (Eigen::Index i = 0; i < water.density.size(); i += 3) water.density[i] = 7800;
  const PressureSystem system = water.assemble();
  for (std::int64_t i = 0; i < system.size(); ++i)
    for (std::int64_t e = system.start[static_cast<std::size_t>(i)];
         e < system.stop[static_cast<std::size_t>(i)]; ++e)
      ASSERT_EQ(system.value[static_cast<std::size_t>(e)],
                entry(system, system.column[static_cast<std::size_t>(e)], i));
}

TEST(Pressure, BothPreconditionersAgreeWithADirectSolver) {
  Block water(30, true);
  const PressureSystem system = water.assemble();
  water.scheme.preconditioner = Preconditioner::jacobi;
  const PressureSolution jacobi = solve(system, water);
  water.scheme.preconditioner = Preconditioner::multilevel;
  const PressureSolution grids = solve(system, water);
  const Eigen::VectorXd direct = direct_pressure(system);
  // Residuals of 1e-12 times a condition number of some 1e3.
  EXPECT_LT((jacobi.pressure - direct).norm(), 1e-8 * direct.norm());
  EXPECT_LT((grids.pressure - direct).norm(), 1e-8 * direct.norm());
  EXPECT_LT(grids.iterations, jacobi.iterations);
  EXPECT_LT(pressure_residual(system, direct), 1e-12);
}

TEST(Pressure, ResultIsTheSameBitForBitOnOneAndTwoThreads) {
  Block water(180, true);  // large enough that threads share the work
  water.scheme.pressure_tolerance = 1e-4;
  const int before = omp_get_max_threads();
  std::array<Eigen::VectorXd, 2> pressure;
  for (int threads = 1; threads <= 2; ++threads) {
    omp_set_num_threads(threads);
    const PressureSystem system = water.assemble();
    pressure[static_cast<std::size_t>(threads - 1)] = solve(system, water).pressure;
  }
  omp_set_num_threads(before);
  EXPECT_TRUE((pressure[0].array() == pressure[1].array()).all());
}

TEST(Pressure, SealedCompressibleWaterAtRestKeepsItsPressure) {
  Block water(12, false);
  water.sound_speed = 1500;
  water.divergence.setZero();
  water.old_pressure.setConstant(4e5);
  const PressureSystem system = water.assemble();
  const PressureSolution solution = solve(system, water);
  EXPECT_LT((solution.pressure.array() - 4e5).abs().maxCoeff(), 1e-6 * 4e5);
}

TEST(Pressure, DriftTermLeavesWaterAloneWhoseDensityFitsItsPressure) {
  Block water(12, false);
  water.sound_speed = 1500;
  water.scheme.source = Source::mixed;
  water.scheme.tau = 1e-3;
  water.divergence.setZero();
  water.old_pressure.setConstant(9.4e6);
  water.deviation.setConstant(9.4e6 / (1000 * 1500.0 * 1500.0));  // p/(ρc²), 0.42 %
  const PressureSystem system = water.assemble();
  const PressureSolution solution = solve(system, water);
  EXPECT_LT((solution.pressure.array() - 9.4e6).abs().maxCoeff(), 1e-6 * 9.4e6);
}

TEST(Pressure, SealedIncompressibleWaterIsFoundAndSolved) {
  Block water(12, false);
  PressureSystem system = water.assemble();
  EXPECT_EQ(close_sealed_blocks(system), 1);
  const PressureSolution solution = solve(system, water);
  EXPECT_TRUE(solution.pressure.allFinite());
  EXPECT_LT(solution.residual, 1e-11);
  EXPECT_NEAR(solution.pressure[0], 0, 1e-8 * solution.pressure.cwiseAbs().maxCoeff());  // the pinned one
  PressureSystem open = Block(12, true).assemble();
  EXPECT_EQ(close_sealed_blocks(open), 0);
}

TEST(Pressure, UnfinishedSolutionSaysSo) {
  Block water(30, true);
  water.scheme.preconditioner = Preconditioner::jacobi;
  water.scheme.pressure_max_iterations = 3;
  const PressureSystem system = water.assemble();
  const PressureSolution solution = solve(system, water);
  EXPECT_EQ(solution.iterations, 3);
  EXPECT_GT(solution.residual, 1e-3);
}

}  // namespace pressure_equation_test
}  // namespace strake::fluid
