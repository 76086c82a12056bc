#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/ranks/flow.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/fluid/same_state.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace {

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

template <int dim>
void expect_same(const Flow<dim>& flow, const std::vector<int>& ranks = {2, 3, 4}) {
  const State<dim> one = on_one_rank(flow);
  ASSERT_TRUE(one.velocity.allFinite());
  EXPECT_GT(one.velocity.norm(), 0);
  for (const int count : ranks) EXPECT_EQ(differences(on_ranks(flow, count), one), "") << count << " ranks";
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

}  // namespace
}  // namespace strake::fluid
