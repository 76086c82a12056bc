#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/ranks/exact_grid.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/fluid/same_state.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace strake::fluid {
namespace {

/// A driven body, or none, and its water. All steps are windows of their own, but for `substeps`.
template <int dim>
struct Flow {
  Parameters p;
  InterfaceMesh body;
  double speed = 0;  // downwards [m/s]
  double dt = 1e-4;
  int steps = 60, substeps = 1;

  Points velocity() const {
    Points v = Points::Zero(3, body.position.cols());
    v.row(1).setConstant(-speed);
    return v;
  }
  State<dim> end(Simulation<dim>& simulation) const {
    const auto m = simulation.interface().position.cols();
    InterfaceMotion motion{Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
    motion.velocity.row(1).setConstant(-speed);
    for (int k = 0; k < steps; ++k) {
      motion.displacement.row(1).setConstant(-speed * (k + 1) * dt);
      simulation.step(dt, motion, (substeps - 1 - k % substeps) * dt);
    }
    return simulation.whole();
  }
  State<dim> on_one_rank() const {
    Simulation<dim> simulation(p, body, velocity());
    return end(simulation);
  }
  State<dim> on_ranks(int count) const {
    std::vector<State<dim>> ends(static_cast<std::size_t>(count));
    ThreadRanks(count).run([&](Communicator& communicator) {
      Simulation<dim> simulation(p, body, velocity(), Ranks{&communicator, cut_in_halves});
      ends[static_cast<std::size_t>(communicator.rank())] = end(simulation);
    });
    for (State<dim>& state : ends) {
      EXPECT_EQ(state.rank_boxes.size(), 6 * count);
      EXPECT_EQ(state.rank_buckets.size(), state.kind.size());
      state.rank_boxes.resize(0);
      state.rank_buckets.clear();
    }
    return ends.front();
  }
};

template <int dim>
void expect_same(const Flow<dim>& flow, const std::vector<int>& ranks = {2, 3, 4}) {
  const State<dim> one = flow.on_one_rank();
  ASSERT_TRUE(one.velocity.allFinite());
  EXPECT_GT(one.velocity.norm(), 0);
  for (const int count : ranks) EXPECT_EQ(differences(flow.on_ranks(count), one), "") << count << " ranks";
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

/// How far the pressure that the ranks solve together is from that of one rank, after the first step, over
/// ρ(gH + U²); and the iterations.
template <int dim>
struct Together {
  double difference = 0;
  int iterations = 0, alone = 0;
};

template <int dim>
Together<dim> solve_together(Flow<dim> flow, int count) {
  flow.steps = 1;
  const auto m = flow.body.position.cols();
  Together<dim> result;
  InterfaceMotion motion;
  const auto one_step = [&](Simulation<dim>& simulation) {
    const auto points = simulation.interface().position.cols();
    motion = {Points::Zero(3, points), Points::Zero(3, points), Points::Zero(3, points)};
    motion.velocity.row(1).setConstant(-flow.speed);
    motion.displacement.row(1).setConstant(-flow.speed * flow.dt);
    return simulation.step(flow.dt, motion).pressure_iterations;
  };
  EXPECT_GE(m, 0);
  Simulation<dim> one(flow.p, flow.body, flow.velocity());
  result.alone = one_step(one);
  ThreadRanks(count).run([&](Communicator& communicator) {
    Simulation<dim> simulation(
        flow.p, flow.body, flow.velocity(),
        Ranks{&communicator, cut_in_halves, [&] { return std::make_unique<ExactGrid>(communicator); }});
    const auto points = simulation.interface().position.cols();
    InterfaceMotion own{Points::Zero(3, points), Points::Zero(3, points), Points::Zero(3, points)};
    own.velocity.row(1).setConstant(-flow.speed);
    own.displacement.row(1).setConstant(-flow.speed * flow.dt);
    const int iterations = simulation.step(flow.dt, own).pressure_iterations;
    const State<dim>& whole = simulation.whole();
    if (communicator.rank() > 0) return;
    result.iterations = iterations;
    const double scale = flow.p.density * (flow.p.gravity.norm() * (flow.p.water.max - flow.p.water.min).y() +
                                           flow.speed * flow.speed);
    result.difference = (whole.pressure - one.state().pressure).cwiseAbs().maxCoeff() / scale;
  });
  return result;
}

template <int dim>
void expect_near(const Flow<dim>& flow) {
  for (const int count : {2, 3, 4, 8}) {
    const Together<dim> result = solve_together(flow, count);
    if (std::getenv("SHOW")) printf("%d ranks: %d iterations, alone %d, difference %.2e\n", count, result.iterations, result.alone, result.difference);
    EXPECT_LE(result.difference, 1e-6) << count << " ranks";
    EXPECT_LE(std::abs(result.iterations - result.alone), 1) << count << " ranks: " << result.iterations;
  }
}

TEST(Ranks, SolveThePressureOfABoxInSpaceTogether) {
  Flow<3> flow{.p = basin(0.6, 0.24, 0.02, 0.1),
               .body = box_surface({0, 0.004, 0}, {0.16, 0.04, 0.16}, 0.02),
               .speed = 3,
               .dt = 5e-5};
  expect_near(flow);
}

TEST(Ranks, SolveThePressureOfAPlateEntryTogether) {
  Flow<2> flow{.p = tank_case(1.6, 0.4, 0.01, 0.2),
               .body = rectangle(-0.1, 0.0002, 0.2, 0.02, 0.01),
               .speed = 6,
               .dt = 2e-5};
  expect_near(flow);
}

TEST(Ranks, SolveThePressureOfAnIncompressibleColumn) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4};
  flow.p.water.max[0] = -0.2;
  expect_near(flow);
}

}  // namespace
}  // namespace strake::fluid
