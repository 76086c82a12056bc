#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/ranks/exact_grid.hpp"
#include "tests/fluid/ranks/flow.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/fluid/solid_case.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

// The pressure that ranks solve together, against that of one rank.

namespace strake::fluid {
namespace pressure_test {

template <int dim>
struct Solved {
  State<dim> state;  // of the whole fluid
  int iterations = 0;
  double asymmetry = 0;  // of the grid's matrix, relative
};

template <int dim>
Solved<dim> together(const Flow<dim>& flow, int count) {
  Solved<dim> solved;
  ThreadRanks(count).run([&](Communicator& communicator) {
    const ExactGrid* grid = nullptr;
    const auto make_grid = [&] {
      auto made = std::make_unique<ExactGrid>(communicator);
      grid = made.get();
      return made;
    };
    Simulation<dim> simulation(flow.p, flow.body, flow.velocity(),
                               Ranks{&communicator, cut_in_halves, make_grid});
    const int iterations = flow.run(simulation).pressure_iterations;
    const State<dim>& whole = simulation.whole();
    if (communicator.rank() == 0) solved = {whole, iterations, grid->asymmetry};
  });
  return solved;
}

/// ρ(gH + U²) [Pa].
template <int dim>
double pressure_scale(const Flow<dim>& flow) {
  const double depth = (flow.p.water.max - flow.p.water.min).y();
  return flow.p.density * (flow.p.gravity.norm() * depth + flow.speed * flow.speed);
}

template <int dim>
void expect_near(Flow<dim> flow) {
  flow.steps = 1;
  Simulation<dim> one(flow.p, flow.body, flow.velocity());
  const int alone = flow.run(one).pressure_iterations;
  for (const int count : {2, 3, 4, 8}) {
    const Solved<dim> solved = together(flow, count);
    const double difference = (solved.state.pressure - one.state().pressure).cwiseAbs().maxCoeff();
    EXPECT_LE(difference, 1e-6 * pressure_scale(flow)) << count << " ranks";
    EXPECT_LE(std::abs(solved.iterations - alone), 1) << count << " ranks: " << solved.iterations;
    EXPECT_LE(solved.asymmetry, 1e-6) << count << " ranks";
  }
}

TEST(RankedPressure, IsThatOfOneRankInAColumn) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4};
  flow.p.water.max[0] = -0.2;
  expect_near(flow);
}

TEST(RankedPressure, IsThatOfOneRankUnderAPlate) {
  expect_near(Flow<2>{.p = tank_case(1.6, 0.4, 0.01, 0.2),
                      .body = rectangle(-0.1, 0.0002, 0.2, 0.02, 0.01),
                      .speed = 6,
                      .dt = 2e-5});
}

// Water above and below a plate that is thinner than the cells: they have two pieces each, also beside cuts.
TEST(RankedPressure, IsThatOfOneRankOnBothSidesOfAThinPlate) {
  expect_near(Flow<2>{.p = tank_case(1.6, 0.4, 0.01, 0.2),
                      .body = rectangle(-0.4, -0.062, 0.8, 0.004, 0.01),
                      .speed = 1,
                      .dt = 2e-5});
}

TEST(RankedPressure, IsThatOfOneRankUnderABoxInSpace) {
  expect_near(Flow<3>{.p = basin(0.6, 0.24, 0.02, 0.1),
                      .body = box_surface({0, 0.004, 0}, {0.16, 0.04, 0.16}, 0.02),
                      .speed = 3,
                      .dt = 5e-5});
}

// Cells at the upper sides are hardly filled: their rows enter the grid entry by entry.
TEST(RankedPressure, IsThatOfOneRankWithSparseCellsInSpace) {
  Flow<3> flow{.p = basin(0.48, 0.48, 0.02, 0.1), .body = {}, .dt = 9e-4};
  expect_near(flow);
}

TEST(RankedPressure, IsThatOfOneRankOverASeam) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.01, 0.2), .body = {}, .dt = 5e-4};
  flow.p.periodic[0] = true;
  flow.p.gravity = {3, -9.81, 0};
  expect_near(flow);
}

// Without a free surface and without sound the pressure has no zero: the mean of the right side is taken out,
// and one particle of the whole is pinned. The block lies on all ranks.
TEST(RankedPressure, OfASealedTankIsThatOfOneRank) {
  Flow<2> flow{.p = tank_case(0.6, 0.3, 0.01, 0.0), .body = {}, .dt = 5e-4};
  flow.p.open_top = false;
  flow.p.motion.amplitude = {0.02, 0, 0};
  flow.p.motion.frequency = 2;
  expect_near(flow);
}

// Rounding grows as the flow goes on; the front of the column hardly feels it.
TEST(RankedPressure, CarriesAColumnAsFarAsOneRank) {
  Flow<2> flow{.p = tank_case(0.8, 0.2, 0.0125, 0.2), .body = {}, .dt = 5e-4, .steps = 120};
  flow.p.water.max[0] = -0.2;
  Simulation<2> one(flow.p, flow.body, flow.velocity());
  flow.run(one);
  const auto front = [](const State<2>& state) {
    double most = -1;
    for (std::size_t i = 0; i < state.kind.size(); ++i)
      if (state.kind[i] == Kind::fluid)
        most = std::max(most, state.position(0, static_cast<Eigen::Index>(i)));
    return most;
  };
  EXPECT_GT(front(one.state()), -0.19);
  for (const int count : {2, 4})
    EXPECT_NEAR(front(together(flow, count).state), front(one.state()), 0.1 * flow.p.spacing);
}

}  // namespace pressure_test
}  // namespace strake::fluid
