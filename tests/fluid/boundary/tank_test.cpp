#include "fluid/boundary/tank.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/mps/number_density.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace tank_test {

constexpr double l0 = 0.01;
using Corners = std::vector<Eigen::Vector3d>;

Parameters polygon_tank(const Corners& corners, double level, bool open = true) {
  Parameters p;
  p.spacing = l0;
  p.tank_polygon = corners;
  p.tank = {corners.front(), corners.front()};
  for (const auto& c : corners) {
    p.tank.min = p.tank.min.cwiseMin(c);
    p.tank.max = p.tank.max.cwiseMax(c);
  }
  p.water = {p.tank.min, {p.tank.max.x(), level, 0}};
  p.open_top = open;
  p.threads = 1;
  return p;
}

/// A basin whose left side slopes at that angle to the horizontal, full to 0.4 m.
Parameters sloping(double degrees) {
  const double run = 0.6 / std::tan(degrees * std::numbers::pi / 180);
  const double left = -std::ceil(run / l0) * l0;
  return polygon_tank({{left - 0.5, 0.6, 0}, {left - 0.5 + run, 0, 0}, {0.8, 0, 0}, {0.8, 0.6, 0}}, 0.4);
}

/// A step in the floor, as seen behind a breakwater.
Corners stepped() {
  return {{0, 0.5, 0},   {0, 0, 0},   {0.4, 0, 0}, {0.4, 0.1, 0},
          {0.6, 0.1, 0}, {0.6, 0, 0}, {1, 0, 0},   {1, 0.5, 0}};
}

struct Density {
  double least = 10, most = 0, mean = 0;
};
/// n/n0 of water at most 2 l0 off a slanted wall, well below the surface.
Density density_at_the_slope(const Parameters& p, double radius) {
  const auto state = fill<2>(p);
  const TankShape<2> shape(p);
  NeighbourSearch<2> search(radius * l0, 0);
  const auto n = number_density(search.update(state.position), radius * l0);
  const double n0 = lattice_constants<2>(radius, l0).n0;
  Density density;
  int count = 0;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Eigen::Vector2d x = state.position.col(k);
    if (state.kind[i] != Kind::fluid || x.y() > p.water.max.y() - 5 * l0 || x.y() < 6 * l0) continue;
    if (shape.distance_to_slanted(x) > 2 * l0) continue;
    density.least = std::min(density.least, n[k] / n0);
    density.most = std::max(density.most, n[k] / n0);
    density.mean += n[k] / n0;
    ++count;
  }
  EXPECT_GT(count, 40);
  density.mean /= count;
  return density;
}

TEST(TankShape, ABoxWalkedAsAPolygonHasTheSameRows) {
  Parameters box;
  box.spacing = l0;
  box.tank = {{0, 0, 0}, {0.5, 0.3, 0}};
  for (const bool open : {true, false}) {
    box.open_top = open;
    const auto polygon = polygon_tank({{0, 0.3, 0}, {0, 0, 0}, {0.5, 0, 0}, {0.5, 0.3, 0}}, 0.2, open);
    const auto expected = TankShape<2>(box).particles(3), rows = TankShape<2>(polygon).particles(3);
    ASSERT_EQ(rows.wall.size(), expected.wall.size());
    ASSERT_EQ(rows.dummy.size(), expected.dummy.size());
    for (const auto& [one, other] :
         {std::pair{&rows.wall, &expected.wall}, std::pair{&rows.dummy, &expected.dummy}})
      for (const auto& particle : *one) {
        const auto twin = std::find_if(other->begin(), other->end(), [&](const auto& q) {
          return (q.position - particle.position).norm() < 1e-9;
        });
        ASSERT_NE(twin, other->end()) << particle.position.transpose();
        if (one == &rows.wall) {
          EXPECT_NEAR((twin->area - particle.area).norm(), 0, 1e-12);
        }
        EXPECT_EQ(twin->floor, particle.floor) << particle.position.transpose();
      }
  }
}

TEST(TankShape, FacesOfAPolygonAreCoveredByTheirRowsArea) {
  const auto p = polygon_tank(
      {{-0.2, 0.5, 0}, {0, 0, 0}, {0.4, 0, 0}, {0.5, 0.1, 0}, {0.6, 0, 0}, {1.1, 0.1, 0}, {1.2, 0.5, 0}},
      0.4);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0;
  for (const auto& particle : TankShape<2>(p).particles(3).wall) {
    sum += particle.area;
    total += particle.area.norm();
  }
  // ∮ n dA of the closed polygon is zero. The walls lack the lid from (1.2, 0.5) to (-0.2, 0.5).
  EXPECT_NEAR(sum.x(), 0, 1e-9);
  EXPECT_NEAR(sum.y(), 1.4, 1e-9);
  const double faces =
      std::hypot(0.2, 0.5) + 0.4 + 2 * std::hypot(0.1, 0.1) + std::hypot(0.5, 0.1) + std::hypot(0.1, 0.4);
  EXPECT_NEAR(total, faces, 0.01 * faces);  // in a corner the two faces' areas join to a shorter vector
}

TEST(TankShape, RowsBehindCornersStandApart) {
  for (const auto& corners : {stepped(), Corners{{-0.2, 0.5, 0},
                                                 {0, 0, 0},
                                                 {0.4, 0, 0},
                                                 {0.5, 0.15, 0},
                                                 {0.6, 0, 0},
                                                 {1.1, 0.1, 0},
                                                 {1.2, 0.5, 0}}}) {
    const auto rows = TankShape<2>(polygon_tank(corners, 0.4)).particles(3);
    std::vector<Eigen::Vector2d> all;
    for (const auto& particle : rows.wall) all.push_back(particle.position);
    for (const auto& particle : rows.dummy) all.push_back(particle.position);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t j = i + 1; j < all.size(); ++j)
        ASSERT_GT((all[i] - all[j]).norm(), 0.69 * l0) << all[i].transpose() << ", " << all[j].transpose();
  }
}

TEST(TankShape, WaterInAPolygonOfRightAnglesHasFullSupportAroundItsSteps) {
  const auto p = polygon_tank(stepped(), 0.3);
  const auto state = fill<2>(p);
  NeighbourSearch<2> search(3.1 * l0, 0);
  const auto n = number_density(search.update(state.position), 3.1 * l0);
  const double n0 = lattice_constants<2>(3.1, l0).n0;
  for (std::size_t i = 0; i < state.kind.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!has_pressure(state.kind[i]) || state.position(1, k) > 0.3 - 4 * l0) continue;
    ASSERT_NEAR(n[k], n0, 1e-9 * n0) << state.position.col(k).transpose();
  }
}

// Lines of the lattice end where a slope cuts them; packing leaves the fraction of a line that fits nowhere.
TEST(TankShape, WaterOnASlopeHasNearlyFullSupport) {
  for (const double degrees : {20.0, 30.0, 45.0, 60.0, 75.0}) {
    const Density near = density_at_the_slope(sloping(degrees), 2.1);
    EXPECT_NEAR(near.mean, 1, 0.02) << degrees;
    EXPECT_GT(near.least, 0.95) << degrees;
    EXPECT_LT(near.most, 1.08) << degrees;
  }
}

// Rows at uneven depths would be waves at the start.
TEST(TankShape, PackedWaterKeepsTheRowUnderItsLevel) {
  for (const double degrees : {30.0, 45.0, 60.0}) {
    const Parameters p = sloping(degrees);
    const auto state = fill<2>(p);
    int count = 0;
    for (std::size_t i = 0; i < state.kind.size(); ++i) {
      const double depth = p.water.max.y() - state.position(1, static_cast<Eigen::Index>(i));
      if (state.kind[i] != Kind::fluid || depth > 0.75 * l0) continue;
      EXPECT_NEAR(depth, 0.5 * l0, 1e-9) << degrees;
      ++count;
    }
    EXPECT_GT(count, 60) << degrees;
  }
}

// At 45 degrees the slope goes through the middles of cells. Half of them are water, whichever way round-off
// decides.
TEST(TankShape, RoundOffDecidesOfNoParticle) {
  const auto counts = [](double nudge) {
    Parameters p = sloping(45);
    for (auto& corner : p.tank_polygon) corner.x() += nudge;
    const auto rows = TankShape<2>(p).particles(3);
    p.tank.min.x() += nudge;
    p.water.min.x() += nudge;
    const auto state = fill<2>(p);
    return std::array{std::ssize(state.kind), std::ssize(rows.wall), std::ssize(rows.dummy)};
  };
  const auto level = counts(0);
  for (const double nudge : {1e-15, -1e-15, 1e-13, -1e-13}) EXPECT_EQ(counts(nudge), level) << nudge;
}

TEST(TankShape, AWaterPolygonAndSeveralBoxesFillTheirArea) {
  auto p = polygon_tank({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}, 0.3);
  p.water_shapes = {
      {{0, 0, 0}, {0.2, 0.3, 0}}, {{0.1, 0.2, 0}, {0.4, 0.4, 0}}, {{0.6, 0, 0}, {1, 0, 0}, {1, 0.2, 0}}};
  const auto state = fill<2>(p);
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  const double area = 0.2 * 0.3 + 0.3 * 0.2 - 0.1 * 0.1 + 0.5 * 0.4 * 0.2;
  EXPECT_NEAR(static_cast<double>(water) * l0 * l0, area, 40 * l0 * l0 * 0.5);  // half a cell along the slope
}

TEST(TankShape, PolygonsThatCanBeNoTankAreRefused) {
  const auto fault = [](const Corners& corners) {
    const auto found = find_box_fault(polygon_tank(corners, 0.3));
    return found ? found->key + ": " + found->expected : std::string("none");
  };
  EXPECT_EQ(fault({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}), "none");
  EXPECT_NE(fault({{1, 0.5, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0.5, 0}}).find("counter-clockwise"),
            std::string::npos);
  EXPECT_NE(fault({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.01, 0}, {1, 0.5, 0}}).find("spacings"),
            std::string::npos);
  EXPECT_NE(fault({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {0.02, 0.05, 0}, {1, 0.5, 0}}).find("sharper"),
            std::string::npos);
  EXPECT_NE(fault({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}, {0.5, -0.1, 0}, {0.2, 0.5, 0}})
                .find("do not cross"),
            std::string::npos);
  // A baffle of two spacings in the middle of the floor.
  EXPECT_NE(fault({{0, 0.5, 0},
                   {0, 0, 0},
                   {0.49, 0, 0},
                   {0.49, 0.2, 0},
                   {0.51, 0.2, 0},
                   {0.51, 0, 0},
                   {1, 0, 0},
                   {1, 0.5, 0}})
                .find("thick"),
            std::string::npos);
}

TEST(TankShape, DropletsMayFlyOverAnOpenSideAndNowhereElse) {
  const TankShape<2> box(polygon_tank({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}, 0.3));
  EXPECT_FALSE(box.left({0.5, 0.2}));
  EXPECT_FALSE(box.left({0.5, 1.95}));
  EXPECT_TRUE(box.left({0.5, 2.05}));
  EXPECT_FALSE(box.left({-0.5 * l0, 0.2}));
  EXPECT_TRUE(box.left({-1.5 * l0, 0.2}));
  EXPECT_TRUE(box.left({1.2, 0.8}));
  EXPECT_TRUE(box.left({0.5, std::nan("")}));
  const TankShape<2> closed(polygon_tank({{0, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}, 0.3, false));
  EXPECT_TRUE(closed.left({0.5, 0.52}));
}

TEST(TankShape, APeriodicBoxHasNoWallsAtItsEnds) {
  Parameters p;
  p.spacing = l0;
  p.tank = {{0, 0, 0}, {0.5, 0.3, 0}};
  p.periodic = {true, false, false};
  const TankShape<2> shape(p);
  const auto rows = shape.particles(3);
  EXPECT_EQ(rows.wall.size(), 50u);
  EXPECT_EQ(rows.dummy.size(), 150u);
  EXPECT_FALSE(shape.left({-1, 0.1}));
  EXPECT_TRUE(shape.left({0.2, -0.1}));
}

TEST(Tank, EveryDummyExtendsTheNearestRow) {
  for (const auto& corners : {stepped(), Corners{{-0.2, 0.5, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}}) {
    const auto p = polygon_tank(corners, 0.4);
    const auto state = fill<2>(p);
    const Tank<2> tank(p, 3.1 * l0, state);
    for (std::int64_t i = tank.first(); i < tank.last(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (state.kind[k] == Kind::wall) {
        EXPECT_EQ(tank.master_of(i), -1);
        continue;
      }
      ASSERT_GE(tank.master_of(i), tank.first());
      if (i % 7) continue;
      const double mine = (state.position.col(tank.master_of(i)) - state.position.col(i)).norm();
      for (std::int64_t w = tank.first(); state.kind[static_cast<std::size_t>(w)] == Kind::wall; ++w)
        ASSERT_GE((state.position.col(w) - state.position.col(i)).norm(), mine - 1e-12);
    }
  }
}

TEST(Tank, CornersOfASpaceBoxHaveMastersOnTheirOwnSide) {
  Parameters p;
  p.dimension = 3;
  p.spacing = 0.1;
  p.tank = {{0, 0, 0}, {1, 1, 0.6}};
  p.water = {{0, 0, 0}, {1, 0.5, 0.6}};
  const auto state = fill<3>(p);
  const Tank<3> tank(p, 0.31, state);
  for (std::int64_t i = tank.first(); i < tank.last(); ++i) {
    const std::int32_t w = tank.master_of(i);
    if (w < 0) continue;
    for (int d = 0; d < 3; ++d) {  // the nearest is the foot on the box of the first layers
      const double high = d == 1 ? p.tank.max[d] - 0.05 : p.tank.max[d] + 0.05;
      EXPECT_NEAR(state.position(d, w), std::clamp(state.position(d, i), p.tank.min[d] - 0.05, high), 1e-9);
    }
  }
}

TEST(Tank, ARollingTankTurnsItsRowsNormalsAndVelocities) {
  auto p = polygon_tank({{-0.5, 0.5, 0}, {-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}}, 0.3);
  p.motion.amplitude = {0.1, 0.02, 0};
  p.motion.roll = 0.2;
  p.motion.frequency = 0.7;
  p.motion.pivot = {0, 0.2, 0};
  p.end_time = 1;
  auto state = fill<2>(p);
  Tank<2> tank(p, 3.1 * l0, state);
  const Vectors<2> before = state.position;
  const double omega = 2 * std::numbers::pi * 0.7;
  // Its water starts with the tank.
  EXPECT_NEAR(state.velocity(0, 0), 0.1 * omega - 0.2 * omega * (before(1, 0) - 0.2), 1e-12);
  constexpr double dt = 1e-3;
  Vectors<2> place = before, velocity = state.velocity;
  for (int step = 0; step < 300; ++step) {
    tank.move(state, state.time + dt, false);
    if (step > 0) {  // what the acceleration says is what the velocity gains
      for (std::int64_t i = tank.first(); i < tank.last(); i += 50)
        ASSERT_NEAR((velocity.col(i) + dt * tank.acceleration_of(i) - state.velocity.col(i)).norm(), 0,
                    1e-12);
      // The frame is where the layers were before this step, in the middle between two velocities.
      ASSERT_NEAR((tank.acceleration_of_frame() - tank.acceleration()).norm(), 0, 1e-4);
    }
    tank.move(state, state.time + dt, true);
    for (std::int64_t i = tank.first(); i < tank.last(); i += 50)
      ASSERT_NEAR((place.col(i) + dt * state.velocity.col(i) - state.position.col(i)).norm(), 0, 1e-12);
    state.time += dt;
    place = state.position;
    velocity = state.velocity;
  }
  const double angle = 0.2 * std::sin(omega * state.time);
  const Eigen::Vector2d n(std::cos(angle), std::sin(angle));
  for (std::int64_t i = tank.first(); i < tank.last(); ++i) {
    EXPECT_NEAR((tank.in_tank(place.col(i)) - before.col(i)).norm(), 0, 1e-12);
    // Second order in the step: the velocity is that of half a step ago.
    EXPECT_NEAR((tank.velocity_at(place.col(i)) - velocity.col(i)).norm(), 0, dt * omega * omega * 0.2);
    if (before(0, i) < -0.5 && before(1, i) > 0) {
      EXPECT_NEAR((tank.normal_of(i) - n).norm(), 0, 1e-12);
    }
  }
}

// As a belt under water that is sheared.
TEST(Tank, APeriodicTankMayRunPastManyPeriods) {
  Parameters p;
  p.spacing = l0;
  p.tank = {{0, 0, 0}, {0.5, 0.3, 0}};
  p.water = {{0, 0, 0}, {0.5, 0.2, 0}};
  p.periodic = {true, false, false};
  p.motion.amplitude = {2.2, 0, 0};
  p.motion.frequency = 1;
  p.end_time = 1;
  auto state = fill<2>(p);
  Tank<2> tank(p, 3.1 * l0, state);
  constexpr double dt = 0.001;
  for (int step = 1; step <= 250; ++step) {
    tank.move(state, step * dt, false);
    const double speed =
        2.2 *
        (std::sin(2 * std::numbers::pi * step * dt) - std::sin(2 * std::numbers::pi * (step - 1) * dt)) / dt;
    for (std::int64_t i = tank.first(); i < tank.last(); i += 7)
      ASSERT_NEAR(state.velocity(0, i), speed, 1e-9) << step;
    tank.move(state, step * dt, true);
    state.time = step * dt;
  }
  for (std::int64_t i = tank.first(); i < tank.last(); ++i) {
    EXPECT_GE(state.position(0, i), 0);
    EXPECT_LT(state.position(0, i), 0.5);
  }
}

TEST(Tank, TheSineOfATankIsSmoothFromItsRampOn) {
  TankMotion motion;
  motion.amplitude = {0.1, 0, 0};
  motion.frequency = 1.3;
  motion.ramp = 0.5;
  constexpr double h = 1e-5;
  for (double t = 0.02; t < 1; t += 0.097) {
    const auto before = motion.at(t - h), now = motion.at(t), after = motion.at(t + h);
    EXPECT_NEAR(now.velocity.x(), (after.displacement.x() - before.displacement.x()) / (2 * h), 1e-6);
    EXPECT_NEAR(now.acceleration.x(), (after.velocity.x() - before.velocity.x()) / (2 * h), 1e-5);
  }
  EXPECT_EQ(motion.at(0).velocity.norm(), 0);
  EXPECT_EQ(motion.at(0).acceleration.norm(), 0);
}

}  // namespace tank_test
}  // namespace strake::fluid
