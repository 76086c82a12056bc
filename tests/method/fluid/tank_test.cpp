#include "fluid/boundary/fill.hpp"
#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::fluid {
namespace {

constexpr double g = 9.81;

/// x(t) = ½ a t² along y, as a table of the case would give it.
MotionTable uniform_acceleration(double a, double end) {
  std::vector<double> time, place;
  for (int k = 0; k <= 20; ++k) {
    time.push_back(end * k / 20);
    place.push_back(0.5 * a * time.back() * time.back());
  }
  constexpr auto absent = MotionColumn::absent;
  return {time, {absent, MotionColumn::place, absent, absent}, {{{}, place, {}, {}}}};
}

/// Mean of the bottom's pressure and of the floor's load over a stretch of time, over ρgH and the weight.
struct Bottom {
  double pressure = 0, load = 0, noise = 0;
};
template <int dim>
Bottom bottom_of(const Parameters& p, double area, double dt, double from, double end, double depth,
                 const Eigen::Vector3d& at, double diameter) {
  Simulation<dim> simulation(p, {}, {});
  const InterfaceMotion none;
  Bottom mean;
  double squares = 0;
  int count = 0;
  const double head = p.density * g * depth;
  for (double t = 0; t < end - 0.5 * dt; t += dt) {
    simulation.step(dt, none);
    if (t < from) continue;
    const double pressure = simulation.sensor_pressure(at, diameter) / head;
    mean.pressure += pressure;
    squares += pressure * pressure;
    mean.load -= simulation.floor_force()[1] / (head * area);
    ++count;
  }
  mean.pressure /= count;
  mean.load /= count;
  mean.noise = std::sqrt(std::max(0.0, squares / count - mean.pressure * mean.pressure));
  EXPECT_EQ(simulation.state().lost, 0);
  return mean;
}

Parameters moving_tank(double width, double depth, double spacing, double acceleration) {
  Parameters p = tank_case(width, depth, spacing, 0.1);
  p.end_time = 1;
  p.motion.table = uniform_acceleration(acceleration, 1);
  return p;
}

// In the first step the tank falls ½ g Δt² and the water, from rest, g Δt². This is a push of half a step's
// fall, of which nothing is left after a few steps.
TEST(Tank, WaterInAFallingTankHasNoPressure) {
  const Bottom bottom =
      bottom_of<2>(moving_tank(0.4, 0.4, 0.02, -g), 0.4, 1e-3, 0.02, 0.3, 0.4, {0, -0.4, 0}, 0.2);
  EXPECT_NEAR(bottom.pressure, 0, 1e-4);
  EXPECT_NEAR(bottom.load, 0, 1e-4);
  EXPECT_LT(bottom.noise, 1e-4);
}

TEST(Tank, WaterInATankThatIsLiftedCarriesItsOwnWeightAndTheLift) {
  const Bottom bottom =
      bottom_of<2>(moving_tank(0.3, 0.6, 0.02, 0.5 * g), 0.3, 1e-3, 0.05, 0.2, 0.6, {0, -0.6, 0}, 0.2);
  EXPECT_NEAR(bottom.pressure, 1.5, 0.015);
  EXPECT_NEAR(bottom.load, 1.5, 0.015);
  EXPECT_LT(bottom.noise, 0.01);
}

TEST(Tank, StillWaterInSpaceWeighsOnItsFloor) {
  Parameters p;
  p.dimension = 3;
  p.spacing = 0.02;
  p.tank = {{0, 0, 0}, {0.2, 0.5, 0.16}};
  p.water = {{0, 0, 0}, {0.2, 0.4, 0.16}};
  p.threads = 1;
  const Bottom bottom = bottom_of<3>(p, 0.2 * 0.16, 1e-3, 0.05, 0.15, 0.4, {0.1, 0, 0.08}, 0.12);
  EXPECT_NEAR(bottom.pressure, 1, 0.01);
  EXPECT_NEAR(bottom.load, 1, 0.01);
  EXPECT_LT(bottom.noise, 0.01);
}

// A basin of slopes. p = ρ g (H − z) on the flat floor, and the walls carry the weight of all the water.
TEST(Tank, WaterBetweenSlopesWeighsOnThem) {
  Parameters p = tank_case(1.0, 0.4, 0.01);
  p.tank_polygon = {{-0.5, 0.1, 0}, {-0.2, -0.4, 0}, {0.1, -0.4, 0}, {0.5, 0.1, 0}};
  p.end_time = 1;
  Simulation<2> simulation(p, {}, {});
  const InterfaceMotion none;
  double pressure = 0;
  Eigen::Vector2d load = Eigen::Vector2d::Zero();
  int count = 0;
  constexpr double dt = 5e-4;
  for (int step = 0; step < 500; ++step) {
    const Eigen::Vector2d before = simulation.state().impulse_on_walls;
    simulation.step(dt, none);
    if (step < 300) continue;
    pressure += simulation.sensor_pressure({-0.05, -0.4, 0}, 0.2);
    load += (simulation.state().impulse_on_walls - before) / dt;
    ++count;
  }
  const auto& state = simulation.state();
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  const double weight = static_cast<double>(water) * p.density * g * p.spacing * p.spacing;
  EXPECT_NEAR(pressure / count, p.density * g * 0.4, 0.01 * p.density * g * 0.4);
  EXPECT_NEAR(-load.y() / count, weight, 0.02 * weight);
  EXPECT_NEAR(load.x() / count, 0, 0.02 * weight);
  EXPECT_EQ(state.lost, 0);
}

/// A channel of 20 particles between walls at y = 0 and 0.2 m that repeats itself along x, closed above.
Parameters channel(WallSlip wall) {
  Parameters p;
  p.spacing = 0.01;
  p.tank = {{0, 0, 0}, {0.2, 0.2, 0}};
  p.water = p.tank;
  p.open_top = false;
  p.periodic = {true, false, false};
  p.wall = wall;
  p.gravity.setZero();
  p.sound_speed = 20;
  p.threads = 1;
  return p;
}

// u = F/(2ν) y (h − y), driven by F; one time h²/(π²ν) of its decay is 0.4 s.
TEST(Tank, WaterBetweenRoughPlatesThatGoOnForEverKeepsItsParabola) {
  constexpr double force = 0.2, nu = 0.01, height = 0.2;
  Parameters p = channel(WallSlip::no_slip);
  p.gravity = {force, 0, 0};
  p.kinematic_viscosity = nu;
  p.scheme.turbulence = Turbulence::none;
  Simulation<2> simulation(p, {}, {});
  const auto exact = [&](double y) { return force / (2 * nu) * y * (height - y); };
  State<2> start = simulation.state();
  const auto water = std::count(start.kind.begin(), start.kind.end(), Kind::fluid);
  for (std::int64_t i = 0; i < water; ++i) start.velocity(0, i) = exact(start.position(1, i));
  simulation.set_state(start);
  for (int step = 0; step < 800; ++step) simulation.step(5e-4, {});
  const auto& state = simulation.state();
  double error = 0, norm = 0;
  for (std::int64_t i = 0; i < water; ++i) {
    const double u = exact(state.position(1, i));
    error += (state.velocity(0, i) - u) * (state.velocity(0, i) - u);
    norm += u * u;
  }
  EXPECT_LT(std::sqrt(error / norm), 0.01);
  EXPECT_EQ(state.lost, 0);
}

TEST(Tank, WaterSlidesBetweenSmoothPlatesThatGoOnForEver) {
  Parameters p = channel(WallSlip::free_slip);
  p.kinematic_viscosity = 0.01;
  Simulation<2> simulation(p, {}, {});
  State<2> start = simulation.state();
  const auto water = std::count(start.kind.begin(), start.kind.end(), Kind::fluid);
  start.velocity.leftCols(water).row(0).setConstant(1.0);
  simulation.set_state(start);
  for (int step = 0; step < 600; ++step) simulation.step(5e-4, {});  // one and a half times around
  const auto velocity = simulation.state().velocity.leftCols(water);
  // The lattice vibrates a little as it passes the wall layers; nothing damps it.
  EXPECT_NEAR(velocity.row(0).mean(), 1, 1e-3);
  EXPECT_LT((velocity.row(0).array() - 1).abs().maxCoeff(), 0.01);
  EXPECT_LT(velocity.row(1).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LE(simulation.state().position.leftCols(water).row(0).maxCoeff(), 0.2);
}

}  // namespace
}  // namespace strake::fluid
