#include "fluid/mps/lattice_filter.hpp"

#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/lattice.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <random>

namespace strake::fluid {
namespace lattice_filter_test {

constexpr double l0 = 0.01, pressure = 5e3, density = 1000, dt = 5e-5;

template <int dim>
struct Block {
  Vectors<dim> position;
  LatticeConstants lattice = lattice_constants<dim>(2.1, l0);
  NeighbourSearch<dim> search{2.1 * l0, 0};
  const Neighbours* rows;
  explicit Block(int side, double disorder = 0.1)
      : position(block<dim>(side, l0, disorder)), rows(&search.update(position)) {}
  Vectors<dim> filtered(const Vectors<dim>& u, double p = pressure) {
    const Eigen::VectorXd pressures = Eigen::VectorXd::Constant(position.cols(), p);
    return filter_lattice<dim>(
        {position, u, pressures, *rows, lattice, position.cols(), 4.0, density, l0, dt});
  }
};

template <int dim>
void leaves_linear_flow_alone() {
  const int side = dim == 2 ? 15 : 11;
  Block<dim> water(side);
  Vectors<dim> u = water.position;
  for (int d = 0; d < dim; ++d) u.row(d) = 3.0 * water.position.row((d + 1) % dim);
  const Vectors<dim> change = water.filtered(u);
  for (const std::int64_t i : interior<dim>(side, 4)) EXPECT_LT(change.col(i).norm(), 1e-12) << i;
}
TEST(LatticeFilter, LeavesFlowThatTheGradientExplainsAlone) {
  leaves_linear_flow_alone<2>();
  leaves_linear_flow_alone<3>();
}

TEST(LatticeFilter, KeepsMomentum) {
  Block<2> water(15);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> value(-1, 1);
  const Vectors<2> u = Vectors<2>::NullaryExpr(2, water.position.cols(), [&] { return value(generator); });
  const Vectors<2> change = water.filtered(u);
  EXPECT_GT(change.norm(), 0.1);
  EXPECT_LT(change.rowwise().sum().norm(), 1e-12 * change.norm());
}

// Layers that slide in opposite directions: each gets a force from the other of β l0 √(P/ρ) a pair.
TEST(LatticeFilter, DampsRowsThatSlideAndOnlyUnderPressure) {
  constexpr int side = 15;
  Block<2> water(side, 0);
  Vectors<2> u = Vectors<2>::Zero(2, water.position.cols());
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    u(0, i) = std::lround((water.position(1, i) - water.position.row(1).minCoeff()) / l0) % 2 ? 1.0 : -1.0;
  const Vectors<2> change = water.filtered(u);
  double opposite = 0;  // Σ w of the neighbours in layers that slide the other way
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x)
      if (y % 2 != 0) opposite += std::max(0.0, 2.1 / std::hypot(x, y) - 1);
  const double viscosity = 4.0 * l0 * std::sqrt(pressure / density);
  const double share = dt * 4.0 / (water.lattice.n0 * water.lattice.lambda0) * viscosity * 2.0 * opposite;
  ASSERT_LT(share, 0.2);  // below the bound of the explicit step
  for (const std::int64_t i : interior<2>(side, 4)) {
    EXPECT_NEAR(change(0, i), -share * u(0, i), 1e-12);
    EXPECT_NEAR(change(1, i), 0, 1e-12);
  }
  EXPECT_EQ(water.filtered(u, 0.0).norm(), 0);
  EXPECT_EQ(water.filtered(u, -pressure).norm(), 0);
}

// A column twice as high as wide under its own weight: without the filter the lattice shears.
double speed_of_a_column_at_rest(double filter) {
  Parameters p = tank_case(0.2, 0.4, 0.02, 0.5);
  p.scheme = with_gradient(p.scheme, Gradient::pairwise);
  p.scheme.filter = filter;
  Simulation<2> simulation(p, {}, {});
  for (int k = 0; k < 3000; ++k) simulation.step(1e-4, {});
  return simulation.state().velocity.colwise().norm().maxCoeff();
}
TEST(LatticeFilter, AColumnUnderItsOwnWeightStaysStill) {
  const double off = speed_of_a_column_at_rest(0), on = speed_of_a_column_at_rest(4);
  RecordProperty("largest_speed_off", std::to_string(off));  // 0.29 m/s
  RecordProperty("largest_speed_on", std::to_string(on));    // 0.05 m/s

  EXPECT_LT(on, 0.5 * off);
}

}  // namespace lattice_filter_test
}  // namespace strake::fluid
