#include "fluid/air/air_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace strake::fluid {
namespace air_layer_test {

using std::numbers::pi;

constexpr double a = 0.2;  // [m] half width or radius

/// Rings and sectors of a disc, open at its rim.
AirColumns<2> disc(double radius, int rings, int sectors) {
  AirColumns<2> columns;
  const double dr = radius / rings, turn = 2 * pi / sectors;
  columns.place.resize(2, rings * sectors);
  columns.area.resize(rings * sectors);
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < sectors; ++s) {
      const int i = r * sectors + s;
      const double inner = r * dr, outer = inner + dr, middle = (s + 0.5) * turn;
      const Eigen::Vector2d out(std::cos(middle), std::sin(middle)), edge((s + 1) * turn, 0);
      // The middle of a sector of a ring, and its area; the sides are straight.
      const double chord = 2 * std::sin(0.5 * turn), flat = std::cos(0.5 * turn);
      columns.area[i] = 0.5 * (outer * outer - inner * inner) * chord * flat;
      columns.place.col(i) = out * flat * 2 / 3 * (outer * outer * outer - inner * inner * inner) /
                             (outer * outer - inner * inner);
      columns.sides.push_back({.column = i,
                               .other = r + 1 < rings ? i + sectors : -1,
                               .normal = out,
                               .length = outer * chord,
                               .middle = out * outer * flat});
      const Eigen::Vector2d along(std::cos(edge.x()), std::sin(edge.x()));
      columns.sides.push_back({.column = i,
                               .other = r * sectors + (s + 1) % sectors,
                               .normal = Eigen::Vector2d(-along.y(), along.x()),
                               .length = dr,
                               .middle = along * (inner + 0.5 * dr)});
    }
  return columns;
}

/// Closes an even gap from h0 at speed V to h, and returns the layer's state there.
template <int plane>
AirState<plane> close_gap(const AirLayer<plane>& layer, double speed, double h0, double h) {
  const int n = layer.columns().size();
  AirState<plane> state = layer.start(Eigen::VectorXd::Constant(n, h0), Eigen::VectorXd::Constant(n, speed));
  const int steps = 500;
  for (int k = 1; k <= steps; ++k)
    layer.advance(state, Eigen::VectorXd::Constant(n, h0 + (h - h0) * k / steps), (h0 - h) / speed / steps);
  return state;
}

template <int plane>
double rise(const AirLayer<plane>& layer, const AirState<plane>& state, int column) {
  return layer.pressure(state)[column] - layer.air().pressure;
}

TEST(AirLayer, AtRestItStaysAtRestOverAnyGap) {
  const AirLayer<1> strip({}, air_strip(-a, a, 40));
  const AirLayer<2> round({}, disc(a, 8, 12));
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> bump(1e-3, 1e-2);
  const auto moves = [&](const auto& layer) {
    const int n = layer.columns().size();
    Eigen::VectorXd gap(n);
    for (int i = 0; i < n; ++i) gap[i] = bump(generator);
    auto state = layer.start(gap, Eigen::VectorXd::Zero(n));
    const double before = layer.mass(state);
    for (int k = 0; k < 200; ++k) layer.advance(state, gap, 5e-6);
    EXPECT_NEAR(layer.mass(state) / before, 1, 1e-12);
    return state.momentum.cwiseAbs().maxCoeff() / (state.mass.maxCoeff() * layer.air().sound_speed());
  };
  EXPECT_LT(moves(strip), 1e-12);
  EXPECT_LT(moves(round), 1e-12);
}

// Slow flow between a closing plate and rigid water: p − p0 = ρ V² a²/h² in the middle of a strip, 3/8 ρ V²
// R²/h² of a disc. The air is all but incompressible where h is far above V a/c0, 0.6 and 1.2 mm here.
TEST(AirLayer, ASlowPlateHasTheCushionOfIncompressibleAir) {
  AirProperties air;
  air.friction = false;
  const AirLayer<1> strip(air, air_strip(-a, a, 81));
  for (const double V : {1.0, 2.0})
    for (const double h : {0.015, 0.010, 0.008}) {
      const double p = rise(strip, close_gap(strip, V, 0.04, h), 40);
      EXPECT_NEAR(p / (air.density * V * V * a * a / (h * h)), 1, 0.05) << V << " " << h;
    }
  const AirLayer<2> round(air, disc(a, 24, 24));
  const double h = 0.01, p = rise(round, close_gap(round, 1, 0.04, h), 0);
  EXPECT_NEAR(p / (0.375 * air.density * a * a / (h * h)), 1, 0.05);
}

TEST(AirLayer, MassIsExactWhileAirFlowsOut) {
  const AirLayer<1> strip({}, air_strip(-a, a, 40));
  const Eigen::VectorXd open = Eigen::VectorXd::Constant(40, 0.012);
  AirState<1> state = strip.start(open, Eigen::VectorXd::Constant(40, 6.26));
  const double before = strip.mass(state);
  for (int k = 1; k <= 1000; ++k)
    strip.advance(state, Eigen::VectorXd::Constant(40, 0.012 - 0.01195 * k / 1000), 0.01195 / 6.26 / 1000);
  EXPECT_NEAR((strip.mass(state) + state.mass_out) / before, 1, 1e-12);
  EXPECT_GT(state.mass_out, 0.3 * before);
  EXPECT_GE(state.mass.minCoeff(), 1.204e-5);
}

// A plate of m = 156 kg/m² falls at V = 6.26 m/s on a sealed layer over rigid water. Energy, with r = p/p0:
// ½ m V² + m g Δh = p0 h0/(γ−1) (r^((γ−1)/γ) − 1) − p0 h0 (1 − r^(−1/γ)). The pressure is 10.787 MPa from 5
// mm, 1.958 MPa from 12 mm.
TEST(AirLayer, ASealedLayerStopsAPlateAtThePressureOfItsEnergy) {
  AirColumns<1> closed = air_strip(-a, a, 10);
  std::erase_if(closed.sides, [](const auto& side) { return side.other < 0; });
  const AirLayer<1> layer({}, closed);
  const double m = 156, g = 9.81, p0 = layer.air().pressure;
  for (const auto& [h0, expected] : {std::pair{0.012, 1957.94e3}, std::pair{0.005, 10.78686e6}}) {
    AirState<1> state{Eigen::VectorXd::Constant(10, 1.204 * h0),
                      Eigen::MatrixXd::Zero(1, 10),
                      Eigen::VectorXd::Constant(10, h0),
                      {},
                      0};
    double h = h0, v = -6.26, largest = 0;
    const double dt = 5e-8;
    for (double t = 0; t < 5e-3 && v < 0; t += dt) {
      v += dt * ((layer.pressure(state)[0] - p0) / m - g);
      h += dt * v;
      layer.advance(state, Eigen::VectorXd::Constant(10, h), dt);
      largest = std::max(largest, rise(layer, state, 5));
    }
    EXPECT_NEAR(largest / expected, 1, 0.005);
  }
}

// A closed tube of 20 p0 is opened. Until the wave is back the flux is ρ_s c_s (2/(γ+1))^((γ+1)/(γ−1)) =
// 0.335 ρ_s c_s.
TEST(AirLayer, AnOpenedTubeIsChoked) {
  AirProperties air;
  air.friction = false;
  AirColumns<1> tube = air_strip(0, a, 100);
  std::erase_if(tube.sides, [](const auto& side) { return side.other < 0 && side.normal[0] < 0; });
  const AirLayer<1> layer(air, tube);
  const double h = 0.01, density = air.density * std::pow(20, 1 / air.gamma), c = air.sound_speed_of(density);
  AirState<1> state{Eigen::VectorXd::Constant(100, density * h),
                    Eigen::MatrixXd::Zero(1, 100),
                    Eigen::VectorXd::Constant(100, h),
                    {},
                    0};
  const double time = 1.5 * a / c;
  for (int k = 0; k < 300; ++k) layer.advance(state, state.gap, time / 300);
  EXPECT_NEAR(state.mass_out / (h * time * density * c) / std::pow(2 / 2.4, 6), 1, 0.02);
}

// Thin air leaves a tube faster than sound, against the open air. It makes no energy, and the open air fills
// the tube again.
TEST(AirLayer, ThinAirThatLeavesFasterThanSoundMakesNoEnergy) {
  AirProperties air;
  air.friction = false;
  const AirLayer<1> layer(air, air_strip(0, a, 10));
  const double h = 0.0005, m = 0.2 * air.density * h;
  AirState<1> state;
  state.mass.setConstant(10, m);
  state.momentum.setConstant(1, 10, 2.9 * air.sound_speed() * m);
  state.momentum.leftCols(5) *= -1;
  state.gap.setConstant(10, h);
  const double before = layer.energy(state);
  for (int k = 0; k < 100; ++k) {
    layer.advance(state, state.gap, 2e-5);
    ASSERT_LT(layer.energy(state) + state.energy_out, 1.001 * before) << k;
  }
  EXPECT_GT(state.mass.minCoeff(), 0.9 * air.density * h);
}

// e is the work against the open air: none at p0, and −dE = (p − p0) dh.
TEST(AirLayer, EnergyIsTheWorkOfThePressure) {
  const AirProperties air;
  const double m = air.density * 0.01;
  EXPECT_NEAR(air.energy_of(m, 0.01, 0), 0, 1e-9 * air.pressure * 0.01);
  for (const double h : {0.002, 0.005, 0.02}) {
    const double d = 1e-6 * h, slope = (air.energy_of(m, h + d, 0) - air.energy_of(m, h - d, 0)) / (2 * d);
    EXPECT_NEAR(slope, air.pressure - air.pressure_of(m, h), 1e-6 * air.pressure_of(m, h));
  }
}

// What the faces give is in the air, has gone over the border, or into friction. Slopes and fluxes dissipate
// a little, and less in narrower columns.
TEST(AirLayer, EnergyIsKept) {
  const auto lost = [](int n, bool friction) {
    AirProperties air;
    air.friction = friction;
    const AirLayer<1> strip(air, air_strip(-a, a, n));
    AirState<1> state = strip.start(Eigen::VectorXd::Constant(n, 0.012), Eigen::VectorXd::Constant(n, 6.26));
    const double start = strip.energy(state), dt = 5e-7, least = 5e-4;
    double work = 0;
    for (double h = 0.012; h > least; h -= 6.26 * dt) {
      strip.advance(state, state.gap, dt);
      const double before = strip.energy(state);
      state.gap.array() -= 6.26 * dt;
      work += strip.energy(state) - before;
    }
    EXPECT_GT(state.energy_out, 0.05 * work);
    return 1 - (strip.energy(state) + state.energy_out) / (start + work);
  };
  const double coarse = lost(20, true), fine = lost(80, true), smooth = lost(80, false);
  EXPECT_LT(std::abs(coarse), 0.005);
  EXPECT_LT(std::abs(fine), 0.5 * std::abs(coarse));
  EXPECT_NEAR(smooth, fine, 0.002);
}

// Water at rest below, incompressible and deep: w_t = −|k| (p − p0)/ρ. The surface is pressed down by
// (4/π)(ρ_a/ρ) a [ln(h0/h) − 1 + h/h0], whatever the speed, until the air is compressed.
TEST(AirLayer, TheWaterIsPressedDownAsTheCushionAsks) {
  AirProperties air;
  air.friction = false;
  const int n = 40, all = 400;
  const double dx = 2 * a / n, V = 1, h0 = 0.04, length = all * dx;
  Eigen::MatrixXd K(n, n);  // |k|/ρ on the strip, of a periodic surface ten times as wide
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double sum = 0;
      for (int m = 1; m < all / 2; ++m)
        sum += 2 * (2 * pi * m / length) * std::cos(2 * pi * m * (i - j) * dx / length);
      K(i, j) = sum / all / 1000;
    }
  const AirLayer<1> layer(air, air_strip(-a, a, n));
  AirState<1> state = layer.start(Eigen::VectorXd::Constant(n, h0), Eigen::VectorXd::Constant(n, V));
  Eigen::VectorXd surface = Eigen::VectorXd::Zero(n), w = surface;
  const double dt = 5e-6;
  double checked[] = {0.02, 0.01, 0.005};
  int next = 0;
  for (double t = dt; next < 3; t += dt) {
    w -= dt * K * (layer.pressure(state).array() - air.pressure).matrix();
    surface += dt * w;
    layer.advance(state, (h0 - V * t) - surface.array(), dt);
    const double h = h0 - V * t;
    if (h > checked[next]) continue;
    const double expected = 4 / pi * air.density / 1000 * a * (std::log(h0 / h) - 1 + h / h0);
    EXPECT_NEAR(-surface.segment(n / 2 - 1, 2).mean() / expected, 1, 0.05) << h;
    ++next;
  }
}

TEST(AirLayer, AirAndSurfaceAgreeOnAGapForAnyPush) {
  const AirProperties air;
  for (const double mass : {1.204e-5, 1e-3, 1e-2})
    for (const double free_gap : {-1e-2, -1e-6, 0.0, 1e-4, 5e-2})
      for (const double compliance : {1e-16, 1e-12, 1e-9}) {
        const double h = air.gap_of(mass, free_gap, compliance), p = air.pressure_of(mass, h);
        ASSERT_GT(h, 0);
        EXPECT_NEAR(h - free_gap, compliance * (p - air.pressure),
                    1e-9 * (h + std::abs(free_gap) + compliance * p));
      }
}

}  // namespace air_layer_test
}  // namespace strake::fluid
