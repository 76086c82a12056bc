#include "fluid/boundary/fill.hpp"
#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace strake::fluid {
namespace tank_test {

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

/// Mean and largest speed of the water [m/s].
struct Speeds {
  double rms = 0, largest = 0;
};
Speeds speeds_of(const State<2>& state) {
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  const auto velocity = state.velocity.leftCols(water);
  return {std::sqrt(velocity.squaredNorm() / static_cast<double>(water)),
          velocity.colwise().norm().maxCoeff()};
}

// Slopes of 45 degrees. Rows at uneven depths, a start with dry faces, and a residual that was removed in
// each step kept the water in motion for ever: 10 mm/s in the mean, 50 to 130 mm/s at the most.
TEST(Tank, StillWaterBetweenSlopesComesToRest) {
  constexpr double l0 = 0.015, depth = 0.3, dt = 2e-3, over_depth = 2.0 / 3;
  Parameters p = tank_case(0.6, depth, l0, 6 * l0);
  const double rim = 0.3 + depth + 6 * l0;
  p.tank_polygon = {{-rim, 6 * l0, 0}, {-0.3, -depth, 0}, {0.3, -depth, 0}, {rim, 6 * l0, 0}};
  p.water = {{-rim, -depth, 0}, {rim, 0, 0}};
  p.end_time = 3;
  Simulation<2> simulation(p, {}, {});
  const auto share = [&](double at) {  // of ρ g times the depth, at that part of the depth
    const Eigen::Vector3d x(0.3 + (1 - at) * depth, -at * depth, 0);
    return simulation.sensor_pressure(x, 4 * l0) / (p.density * g * at * depth);
  };
  double middle = 0, low = 0, largest = 0;
  for (int step = 0; step < 1500; ++step) {
    simulation.step(dt, {});
    if (step < 1000) continue;
    middle += share(0.5) / 500;
    low += share(over_depth) / 500;
    largest = std::max(largest, speeds_of(simulation.state()).largest);
  }
  EXPECT_NEAR(middle, 1, 0.005);
  EXPECT_NEAR(low, 1, 0.005);
  EXPECT_LT(largest, 0.01);
  EXPECT_LT(speeds_of(simulation.state()).rms, 1.5e-3);
  EXPECT_EQ(simulation.state().lost, 0);
}

// Particles 0.1 l0 off their lattice, between seams, so that no wall stands beside the surface. With the
// residual removed in each step the mean speed after 1.5 s was 5 mm/s with long and 20 mm/s with short steps.
TEST(Tank, DisorderedWaterSettlesWhateverTheStep) {
  constexpr double l0 = 0.015;
  for (const double dt : {2e-3, 5e-4}) {
    Parameters p = tank_case(0.6, 0.3, l0);
    p.tank.max.y() = 6 * l0;
    p.periodic = {true, false, false};
    p.end_time = 1.5;
    Simulation<2> simulation(p, {}, {});
    State<2> start = simulation.state();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> move(-0.1 * l0, 0.1 * l0);
    const auto water = std::count(start.kind.begin(), start.kind.end(), Kind::fluid);
    for (std::int64_t i = 0; i < water; ++i)
      start.position.col(i) += Eigen::Vector2d(move(random), move(random));
    for (std::size_t i = 0; i < start.kind.size(); ++i)
      if (start.kind[i] == Kind::wall && start.position(1, static_cast<Eigen::Index>(i)) < -0.3)
        start.surface[i] = 0;  // the floor is wet
    simulation.set_state(start);
    for (double t = 0; t < 1.5; t += dt) simulation.step(dt, {});
    EXPECT_LT(speeds_of(simulation.state()).rms, 3e-3) << dt;
  }
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

}  // namespace tank_test
}  // namespace strake::fluid
