#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/ranks/flow.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/fluid/same_state.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <numeric>
#include <string>

namespace strake::fluid {
namespace ranks_test {

/// The state of the whole fluid after all steps.
template <int dim>
State<dim> on_one_rank(const Flow<dim>& flow) {
  Simulation<dim> simulation(flow.p, flow.body, flow.velocity());
  flow.run(simulation);
  return simulation.state();
}

template <int dim>
State<dim> on_ranks(const Flow<dim>& flow, int count) {
  State<dim> end;
  ThreadRanks(count).run([&](Communicator& communicator) {
    Simulation<dim> simulation(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
    flow.run(simulation);
    const State<dim>& whole = simulation.whole();
    if (communicator.rank() == 0) end = whole;
  });
  EXPECT_EQ(end.rank_boxes.size(), 6 * count);
  EXPECT_EQ(end.rank_buckets.size(), end.kind.size());
  end.rank_boxes.resize(0);
  end.rank_buckets.clear();
  return end;
}

/// Expects the same bits, but in the impulses on walls and of collisions with walls: ranks add them up one by
/// one.
template <int dim>
void expect_same(State<dim> of_ranks, const State<dim>& one, const std::string& what) {
  EXPECT_LE((of_ranks.impulse_on_walls - one.impulse_on_walls).norm(),
            1e-12 * (one.impulse_on_walls.norm() + one.impulse_of_gravity.norm()))
      << what;
  EXPECT_LE((of_ranks.impulse_of_collisions - one.impulse_of_collisions).norm(),
            1e-12 * (one.impulse_on_walls.norm() + one.impulse_of_gravity.norm()))
      << what;
  of_ranks.impulse_on_walls = one.impulse_on_walls;
  of_ranks.impulse_of_collisions = one.impulse_of_collisions;
  EXPECT_EQ(differences(of_ranks, one), "") << what;
}

/// Returns the state on one rank.
template <int dim>
State<dim> expect_same(const Flow<dim>& flow, const std::vector<int>& ranks = {2, 3, 4}) {
  const State<dim> one = on_one_rank(flow);
  EXPECT_TRUE(one.velocity.allFinite());
  EXPECT_GT(one.velocity.norm(), 0);
  for (const int count : ranks) expect_same(on_ranks(flow, count), one, std::to_string(count) + " ranks");
  return one;
}

TEST(Ranks, ACollapsingColumnIsThatOfOneRankToTheLastBit) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}};
  flow.p.water.max[0] = -0.2;
  flow.dt = 5e-4;
  flow.steps = 130;
  expect_same(flow);
}

TEST(Ranks, APlateEntryIsThatOfOneRankToTheLastBit) {
  Flow<2> flow{.p = tank_case(0.6, 0.15, 0.01, 0.2),
               .body = rectangle(-0.1, 0.0002, 0.2, 0.02, 0.01),
               .speed = 6,
               .dt = 2e-6};
  flow.p.sound_speed = 1500;
  flow.steps = 100;
  flow.substeps = 5;
  expect_same(flow);
}

// The oblique faces of a wedge have no images, but two velocities (F74), a lag (F71) and films (F69).
TEST(Ranks, AWedgeEntryIsThatOfOneRankToTheLastBit) {
  Flow<2> flow{.p = tank_case(0.6, 0.15, 0.01, 0.2),
               .body = structure::outline({{0, 0.002}, {0.15, 0.05}, {-0.15, 0.05}}, 0.01),
               .speed = 5,
               .dt = 1e-5};
  flow.p.sound_speed = 1500;
  flow.steps = 400;
  expect_same(flow);
}

TEST(Ranks, ASeamMayLieOnACut) {
  Flow<2> flow{.p = tank_case(0.4, 0.15, 0.01, 0.2), .body = {}};
  flow.p.periodic[0] = true;
  flow.p.gravity = {3, -9.81, 0};
  flow.dt = 5e-4;
  flow.steps = 80;
  expect_same(flow);
}

TEST(Ranks, AMovingTankIsThatOfOneRankToTheLastBit) {
  Flow<2> flow{.p = tank_case(0.4, 0.15, 0.01, 0.2), .body = {}};
  flow.p.motion.amplitude = {0.02, 0, 0};
  flow.p.motion.roll = 0.1;
  flow.p.motion.frequency = 2;
  flow.dt = 5e-4;
  flow.steps = 80;
  expect_same(flow);
}

TEST(Ranks, ABoxInSpaceIsThatOfOneRankToTheLastBit) {
  Flow<3> flow{.p = basin(0.4, 0.12, 0.02, 0.1),
               .body = box_surface({0, 0.004, 0}, {0.16, 0.04, 0.16}, 0.02),
               .speed = 3,
               .dt = 5e-5};
  flow.p.sound_speed = 1500;
  flow.steps = 55;
  expect_same(flow, {2, 4});
}

// Pairs of water have the length of the way around the keel on every rank, and the keel covers parts of the
// side walls' faces.
TEST(Ranks, AKeelInSpaceIsThatOfOneRankToTheLastBit) {
  Flow<3> flow{.p = basin(0.4, 0.12, 0.02, 0.14),
               .body = structure::prism_surface(
                   structure::outline({{0, 0.004}, {0.06, 0.08}, {-0.06, 0.08}}, 0.02), 0.4, 0, 0.02),
               .speed = 5,
               .dt = 1e-4};
  flow.p.sound_speed = 1500;
#ifdef STRAKE_SANITIZED  // a third of the work, with which the keel is in the water as well
  flow.steps = 30;
  const State<3> end = expect_same(flow, {2});
#else
  flow.steps = 60;
  const State<3> end = expect_same(flow, {2, 4});
#endif
  int wet = 0;
  for (std::size_t i = 0; i < end.kind.size(); ++i)
    wet += end.kind[i] == Kind::interface && end.surface[i] == 0 ? 1 : 0;
  EXPECT_GT(wet, 10) << "faces of the keel";
}

/// Water in the plane that gravity drives along a floor without slip, with the k model.
Flow<2> sheared() {
  Flow<2> flow{.p = tank_case(0.4, 0.15, 0.01, 0.2), .body = {}};
  flow.p.periodic[0] = true;
  flow.p.gravity = {3, -9.81, 0};
  flow.p.kinematic_viscosity = 1e-3;
  flow.p.wall = WallSlip::no_slip;
  flow.p.scheme.turbulence = Turbulence::k;
  flow.p.scheme.wall_damping = true;
  flow.dt = 5e-4;
  flow.steps = 120;
  return flow;
}

// Beside a wall the force on the water is the fourth sum in turn: it reads k, which is sent before.
TEST(Ranks, EnergyOfTurbulenceIsThatOfOneRankToTheLastBit) {
  EXPECT_GT(expect_same(sheared()).sps_k.maxCoeff(), 1e-6);
}

// The flow crosses the seam of the tank in each of its sums.
TEST(Ranks, EnergyOfTurbulenceBySeparateSumsIsThatOfOneRankToTheLastBit) {
  Flow<2> flow = sheared();
  flow.p.scheme.sps = SpsForm::stress_pair;
  const State<2> end = expect_same(flow);
  EXPECT_GT(end.sps_k.maxCoeff(), 1e-7);
  EXPECT_LT(end.sps_k.maxCoeff(), 1e-3);
  EXPECT_LT(end.velocity.norm(), 1.1 * on_one_rank(sheared()).velocity.norm());
}

TEST(Ranks, EnergyOfTurbulenceInSpaceIsThatOfOneRankToTheLastBit) {
  Flow<3> flow{.p = basin(0.4, 0.1, 0.02, 0.1), .body = {}, .dt = 5e-4, .steps = 25};
  flow.p.gravity = {6, -9.81, 3};
  flow.p.kinematic_viscosity = 1e-2;
  flow.p.wall = WallSlip::no_slip;
  flow.p.scheme.turbulence = Turbulence::k;
  EXPECT_GT(expect_same(flow, {2, 4}).sps_k.maxCoeff(), 1e-9);
}

// Sixteen parts of a column; those in its middle are far from all walls.
// With so large a distance the rows of the surface collide in chains, across cuts too. Ghosts pass collisions
// on, though they have no rows.
TEST(Ranks, ChainsOfCollisionsAcrossCutsAreThoseOfOneRank) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4, .steps = 80};
  flow.p.water.max[0] = -0.2;
  flow.p.scheme.collision_distance = 1.02;
  const State<2> one = on_one_rank(flow);
  for (const int count : {2, 3, 4}) expect_same(on_ranks(flow, count), one, std::to_string(count) + " ranks");
}

TEST(Ranks, OneWithoutLayersComputesAsTheOthers) {
  Flow<2> flow{.p = tank_case(0.6, 0.6, 0.01, 0.1), .body = {}, .dt = 5e-4, .steps = 55};
  flow.p.gravity = {2, -9.81, 0};
  const State<2> one = on_one_rank(flow);
  expect_same(on_ranks(flow, 16), one, "sixteen ranks");
  std::array<std::size_t, 16> layers{};
  ThreadRanks(16).run([&](Communicator& communicator) {
    Simulation<2> part(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
    layers[static_cast<std::size_t>(communicator.rank())] =
        part.ranks().subdomain()->division().layer_number.size();
  });
  EXPECT_EQ(std::ranges::min(layers), 0U);
}

// At the end of a step the ghosts are those of their owners. Before the next one the changes alone are sent.
TEST(Ranks, SendTheMotionOfGhostsOnce) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4, .steps = 3};
  flow.p.water.max[0] = -0.2;
  ThreadRanks(2).run([&](Communicator& communicator) {
    Simulation<2> part(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
    flow.run(part);
    const Subdomain<2>& own = *part.ranks().subdomain();
    const Halo& ghosts = own.division().ghosts;
    const auto other = static_cast<std::size_t>(1 - communicator.rank());
    const std::int32_t mine = ghosts.send[other][7], theirs = ghosts.receive[other][7],
                       unmoved = ghosts.receive[other][8];
    const auto bytes_of = [&](const auto& act) {
      const std::int64_t before = communicator.account().bytes;
      act();
      return communicator.account().bytes - before;
    };
    State<2> state = part.state();
    own.send_motion(state);
    const State<2> sent = state;
    EXPECT_EQ(bytes_of([&] { own.refresh(state); }), 8) << "nothing has changed";
    state.velocity(1, mine) = 3.5 + communicator.rank();  // its owner has moved it,
    state.position.col(unmoved).setConstant(7);           // and this rank one of its ghosts
    EXPECT_EQ(bytes_of([&] { own.refresh(state); }), 8 + 40) << "one has changed";
    EXPECT_EQ(state.velocity(1, theirs), 3.5 + (1 - communicator.rank()));
    State<2> expected = sent;
    expected.velocity(1, mine) = state.velocity(1, mine);
    expected.velocity(1, theirs) = state.velocity(1, theirs);
    EXPECT_EQ(state.position, expected.position);
    EXPECT_EQ(state.velocity, expected.velocity);
    part.restore(part.snapshot());
    const auto whole = static_cast<std::int64_t>(32 * ghosts.send[other].size());
    EXPECT_EQ(bytes_of([&] { own.refresh(state); }), whole) << "after a rewind";
  });
}

// A long tank: no rank has most of its walls, but together they have all.
TEST(Ranks, EachHasTheLayersOfTheTankNearItsWater) {
  const Flow<3> flow{.p = basin(2.4, 0.12, 0.02, 0.1), .body = {}, .dt = 5e-4, .steps = 1};
  std::array<std::size_t, 4> layers{}, owned{};
  std::int64_t of_whole = 0;
  ThreadRanks(4).run([&](Communicator& communicator) {
    Simulation<3> part(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
    flow.run(part);
    const auto r = static_cast<std::size_t>(communicator.rank());
    const Division& division = part.ranks().subdomain()->division();
    layers[r] = division.layer_number.size();
    owned[r] = static_cast<std::size_t>(std::ranges::count(division.layer_owner, communicator.rank()));
    if (r == 0) of_whole = part.ranks().subdomain()->layers_of_whole();
  });
  const auto whole = static_cast<std::size_t>(of_whole);
  EXPECT_EQ(std::accumulate(owned.begin(), owned.end(), std::size_t{0}), whole);
  for (const std::size_t count : layers) EXPECT_LT(count, whole / 2);
}

/// Computes each window of so many steps twice on several ranks. changes: how often a rank went back to
/// another division than the one that it had come to, by `differ`.
State<2> with_windows_computed_twice(
    const Flow<2>& flow, int window, int count, int& changes,
    const std::function<bool(const Simulation<2>&, const Simulation<2>::Snapshot&)>& differ) {
  std::atomic<int> all_changes = 0;
  State<2> end;
  ThreadRanks(count).run([&](Communicator& communicator) {
    Simulation<2> part(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
    for (int k = 0; k < flow.steps; k += window) {
      const Simulation<2>::Snapshot before = part.snapshot();
      for (const bool again : {false, true}) {
        if (again) {
          if (differ(part, before)) ++all_changes;
          part.restore(before);
          EXPECT_EQ(part.ranks().subdomain()->division().layer_number, before.division->layer_number);
        }
        for (int n = k; n < k + window; ++n) flow.step(part, n);
      }
    }
    const State<2>& whole = part.whole();
    if (communicator.rank() == 0) end = whole;
  });
  changes = all_changes;
  end.rank_boxes.resize(0);
  end.rank_buckets.clear();
  return end;
}

// A window is computed again after a rewind. Where its second step has divided the water anew, a rank goes
// back to another number of particles, and computes the first step with it.
TEST(Ranks, AWindowThatDividesTheWaterMayBeComputedAgain) {
  Flow<2> flow{.p = tank_case(0.6, 0.15, 0.01, 0.2),
               .body = rectangle(-0.1, 0.0002, 0.2, 0.02, 0.01),
               .speed = 6,
               .dt = 2e-5,
               .steps = 104};
  flow.p.sound_speed = 1500;
  const State<2> one = on_one_rank(flow);
  for (const int count : {2, 3}) {
    int changes = 0;
    const auto size_differs = [](const Simulation<2>& part, const Simulation<2>::Snapshot& before) {
      return part.state().kind.size() != before.state.kind.size();
    };
    expect_same(with_windows_computed_twice(flow, 4, count, changes, size_differs), one,
                std::to_string(count) + " ranks");
    EXPECT_GT(changes, 1) << count << " ranks";
  }
}

// A column collapses through the cuts. The first time a window moves the boxes of the ranks. The second time
// it moves them to the same places: a rank has the layer particles of the old boxes until then.
TEST(Ranks, AWindowThatMovesTheBoxesMayBeComputedAgain) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4, .steps = 130};
  flow.p.water.max[0] = -0.2;
  const State<2> one = on_one_rank(flow);
  for (const int count : {3, 5}) {
    int changes = 0;
    const auto layers_differ = [](const Simulation<2>& part, const Simulation<2>::Snapshot& before) {
      return part.ranks().subdomain()->division().layer_number != before.division->layer_number;
    };
    expect_same(with_windows_computed_twice(flow, 2, count, changes, layers_differ), one,
                std::to_string(count) + " ranks");
    EXPECT_GT(changes, 0) << count << " ranks";
  }
}

// The limit of viscosity reads the largest k: ghosts, which lack neighbours, must not set it.
TEST(Ranks, TheStableStepIsThatOfOneRank) {
  for (const Turbulence model : {Turbulence::statics, Turbulence::k}) {
    Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}};
    flow.p.water.max[0] = -0.2;
    flow.p.kinematic_viscosity = 0.02;
    flow.p.scheme.turbulence = model;
    flow.dt = 4e-4;
    flow.steps = 40;
    Simulation<2> one(flow.p, flow.body, flow.velocity());
    flow.run(one);
    const double limit = one.stable_dt();
    EXPECT_LT(limit, 0.125 * 1e-4 / flow.p.kinematic_viscosity);  // by less than viscosity alone
    for (const int count : {2, 4}) {
      std::vector<double> of_ranks(static_cast<std::size_t>(count));
      ThreadRanks(count).run([&](Communicator& communicator) {
        Simulation<2> part(flow.p, flow.body, flow.velocity(), Ranks{&communicator, cut_in_halves});
        flow.run(part);
        of_ranks[static_cast<std::size_t>(communicator.rank())] = part.stable_dt();
      });
      EXPECT_EQ(of_ranks, std::vector<double>(of_ranks.size(), limit));
    }
  }
}

}  // namespace ranks_test
}  // namespace strake::fluid
