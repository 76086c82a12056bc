#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/same_state.hpp"
#include "tests/method/fluid/known_flows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strake::fluid {
namespace {

using std::numbers::pi;

/// A unit box full of water without gravity, closed on all sides, incompressible and laminar.
Parameters closed_box(int across, double viscosity) {
  Parameters p;
  p.spacing = 1.0 / across;
  p.tank.min = {0, 0, 0};
  p.tank.max = {1, 1, 0};
  p.water = p.tank;
  p.open_top = false;
  p.gravity.setZero();
  p.sound_speed = std::numeric_limits<double>::infinity();
  p.kinematic_viscosity = viscosity;
  p.scheme.turbulence = Turbulence::none;
  p.threads = 1;
  return p;
}

// cases/VALIDATION.md, "Viscous flows": u = ½ (F/ν) y (1 − y) less its start-up series, walls without slip,
// periodic along x. ν = 1, F = 1: the flow is steady at t = 0.5, when the middle has gone a twentieth of its
// width; at t = 3 its rows have passed one another by up to a third of it.
TEST(ViscousFlow, a_channel_between_rough_walls_follows_its_start_up_series_within_1_percent) {
  constexpr int across = 20;
  Parameters p = closed_box(across, 1);
  p.periodic[0] = true;
  p.wall = WallSlip::no_slip;
  p.gravity = {1, 0, 0};
  Simulation<2> simulation(p, {}, {});
  const State<2>& state = simulation.state();
  for (const double stop : {0.02, 0.1, 0.3, 1.0, 3.0}) {
    while (state.time < stop - 1e-12)
      simulation.step(std::min(simulation.stable_dt(), stop - state.time), {});
    EXPECT_LT(channel_error(state), 0.01) << "t = " << stop;
  }
  EXPECT_EQ(state.lost, 0);
}

// cases/VALIDATION.md, "Viscous flows": four vortices at Re = 100 in a box with smooth walls; their energy
// falls as e^{−16π²νt}. The gate of 3 % is for 100 particles across (tests/benchmark/fluid/accuracy.cpp: 1.5
// %); half as many are allowed twice as much. The vortices' strain breaks up the lattice the run starts from
// within a fifth of their turn. No surface may open in the closed box and no particle leave it.
TEST(ViscousFlow, taylor_green_vortices_keep_the_box_full_and_decay_without_gaining_energy) {
  Parameters p = closed_box(50, 0.01);
  Simulation<2> simulation(p, {}, {});
  State<2> turning = simulation.state();
  const std::int64_t water = water_of(turning);
  for (std::int64_t i = 0; i < water; ++i) {
    const double x = 2 * pi * turning.position(0, i), y = 2 * pi * turning.position(1, i);
    turning.velocity.col(i) << std::sin(x) * std::cos(y), -std::cos(x) * std::sin(y);
  }
  simulation.set_state(turning);
  const State<2>& state = simulation.state();
  const auto energy = [&] { return state.velocity.leftCols(water).squaredNorm(); };
  const double start = energy();
  double before = start;
  while (state.time < 0.4) {
    simulation.step(simulation.stable_dt(), {});
    EXPECT_LT(energy(), before);
    before = energy();
  }
  const double rate = -std::log(energy() / start) / state.time;
  EXPECT_NEAR(rate / (16 * pi * pi * 0.01), 1, 0.06);
  EXPECT_EQ(state.lost, 0);
  for (std::int64_t i = 0; i < water; ++i) {
    EXPECT_GT(state.position.col(i).minCoeff(), 0);
    EXPECT_LT(state.position.col(i).maxCoeff(), 1);
  }
}

// The models in a whole run. k and the distance to the walls are carried through the steps, and the result
// does not depend on the number of threads.
TEST(ViscousFlow, every_model_runs_in_a_tank_and_gives_the_same_bits_on_two_threads) {
  for (const Turbulence model : {Turbulence::statics, Turbulence::k}) {
    Parameters p = closed_box(16, 1e-4);
    p.open_top = true;
    p.water.max[1] = 0.75;
    p.gravity = {0, -9.81, 0};
    p.scheme.turbulence = model;
    p.scheme.wall_damping = true;
    p.wall = WallSlip::no_slip;
    std::vector<State<2>> ends;
    for (const int threads : {1, 2}) {
      p.threads = threads;
      Simulation<2> simulation(p, {}, {});
      State<2> start = simulation.state();
      start.velocity.row(0).head(water_of(start)) = 0.5 * start.position.row(1).head(water_of(start));
      simulation.set_state(start);
      for (int step = 0; step < 10; ++step) simulation.step(1e-3, {});
      ends.push_back(simulation.state());
    }
    EXPECT_GT(ends[0].sps_k.head(water_of(ends[0])).minCoeff(), 0);
    EXPECT_EQ(differences(ends[0], ends[1]), "");
  }
}

}  // namespace
}  // namespace strake::fluid
