#include "fluid/air/surface_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace strake::fluid {
namespace surface_response_test {

using std::numbers::pi;

constexpr double l0 = 0.01, density = 1000;

template <int plane>
AirState<plane> with_air(int n, double gap = 0.001) {
  AirState<plane> state;
  state.mass.setOnes(n);
  state.gap.setConstant(n, gap);
  return state;
}

/// Columns l0 wide: along × across cells of a rectangle about the origin, joined to their neighbours.
AirColumns<2> cells(int along, int across) {
  AirColumns<2> columns;
  columns.place.resize(2, along * across);
  columns.area.setConstant(along * across, l0 * l0);
  for (int i = 0; i < along; ++i)
    for (int k = 0; k < across; ++k) {
      const int c = i * across + k;
      const Eigen::Vector2d at = l0 * Eigen::Vector2d(i + 0.5 - 0.5 * along, k + 0.5 - 0.5 * across);
      columns.place.col(c) = at;
      const auto side = [&](int other, double x, double z) {
        const Eigen::Vector2d normal(x, z);
        columns.sides.push_back(
            {.column = c, .other = other, .normal = normal, .length = l0, .middle = at + 0.5 * l0 * normal});
      };
      side(i + 1 < along ? c + across : -1, 1, 0);
      side(k + 1 < across ? c + 1 : -1, 0, 1);
      if (i == 0) side(-1, -1, 0);
      if (k == 0) side(-1, 0, -1);
    }
  return columns;
}

// Deep water under p = P cos(kx): the surface has −(k/ρ) p, and the water at the depth d e^(−kd) of it.
TEST(SurfaceResponse, AWaveOfPressureMovesTheSurfaceMoreThanTheRow) {
  constexpr int n = 201, middle = 100;
  const AirColumns<1> columns = air_strip(-0.5 * n * l0, 0.5 * n * l0, n);
  const SurfaceResponse<1> response(columns, l0, density);
  for (const double wave : {8.0, 16.0, 32.0}) {  // [l0]
    const double k = 2 * pi / (wave * l0);
    const Eigen::VectorXd pressure = (k * columns.place.row(0).array()).cos().transpose();
    const double expected = -k / density * (1 - std::exp(-0.5 * k * l0));
    EXPECT_NEAR(response.acceleration(columns, with_air<1>(n), pressure)[middle], expected, -0.15 * expected)
        << wave;
  }
}

// Under an even pressure that ends at a line the surface at x beside it has −p/(πρx).
TEST(SurfaceResponse, ThePressureOfTheLastColumnEndsAtTheBorder) {
  constexpr int n = 40;
  const AirColumns<1> columns = air_strip(0, n * l0, n);
  const SurfaceResponse<1> response(columns, l0, density);
  const Eigen::VectorXd p = Eigen::VectorXd::Constant(n, 1e5);
  const Eigen::VectorXd a = response.acceleration(columns, with_air<1>(n), p);
  for (const int c : {1, 2}) {
    const double x = (c + 0.5) * l0, row = 1e5 / (pi * density) * x / (x * x + 0.25 * l0 * l0);
    EXPECT_NEAR(a[c] - row, -1e5 / (pi * density * x), 0.01 * 1e5 / (pi * density * x)) << c;
    EXPECT_NEAR(a[n - 1 - c], a[c], 1e-9 * std::abs(a[c])) << c;
  }
  EXPECT_NEAR(a[n / 2], 0, 1e-9);
}

// There the pressure falls over the gap h, at least over 0.1 l0: at x the surface has −p/(πρ) x/(x² + h²) and
// the row −p/(πρ) x/(x² + d²). The column beside the border has the mean over its width.
TEST(SurfaceResponse, TheLastColumnHasTheMeanOverItsWidth) {
  constexpr int n = 40, points = 20000;
  const AirColumns<1> columns = air_strip(0, n * l0, n);
  const SurfaceResponse<1> response(columns, l0, density);
  const Eigen::VectorXd p = Eigen::VectorXd::Constant(n, 1e5);
  for (const auto& [gap, fall] : {std::pair(1e-5, 0.1 * l0), std::pair(0.3 * l0, 0.3 * l0)}) {
    double mean = 0;
    for (int k = 0; k < points; ++k) {
      const double x = (k + 0.5) * l0 / points;
      mean -= 1e5 / (pi * density) * (x / (x * x + fall * fall) - x / (x * x + 0.25 * l0 * l0)) / points;
    }
    const Eigen::VectorXd a = response.acceleration(columns, with_air<1>(n, gap), p);
    EXPECT_NEAR(a[0], mean, 1e-3 * std::abs(mean)) << gap;
    EXPECT_NEAR(a[n - 1], a[0], 1e-9 * std::abs(a[0])) << gap;
  }
}

TEST(SurfaceResponse, NothingJumpsAtAColumnInContact) {
  constexpr int n = 20;
  const AirColumns<1> columns = air_strip(0, n * l0, n);
  const SurfaceResponse<1> response(columns, l0, density);
  AirState<1> state = with_air<1>(n);
  state.mass[0] = 0;
  const Eigen::VectorXd a = response.acceleration(columns, state, Eigen::VectorXd::Constant(n, 1e5));
  EXPECT_EQ(a[1], 0);
  EXPECT_LT(a[n - 1], -1000);
}

// A long strip of cells has in its middle what a line of columns has.
TEST(SurfaceResponse, ALongStripInSpaceIsTheLine) {
  constexpr int along = 10, across = 41;
  const AirColumns<2> strip = cells(along, across);
  const AirColumns<1> line = air_strip(-0.5 * along * l0, 0.5 * along * l0, along);
  Eigen::VectorXd p(along), on_cells(along * across);
  for (int i = 0; i < along; ++i) {
    p[i] = 1e4 * (1 + 0.3 * i);
    on_cells.segment(i * across, across).setConstant(p[i]);
  }
  const Eigen::VectorXd in_plane =
      SurfaceResponse<1>(line, l0, density).acceleration(line, with_air<1>(along), p);
  const Eigen::VectorXd in_space =
      SurfaceResponse<2>(strip, l0, density).acceleration(strip, with_air<2>(along * across), on_cells);
  for (int i = 0; i < along; ++i)
    EXPECT_NEAR(in_space[i * across + across / 2], in_plane[i], 0.02 * std::abs(in_plane[0])) << i;
}

}  // namespace surface_response_test
}  // namespace strake::fluid
