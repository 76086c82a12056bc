#include "fluid/replay/replay.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace {

/// Three points, two windows of 1 ms with forces 1 N and 3 N.
InterfaceRecord record() {
  InterfaceRecord r;
  r.mesh.position = Points{{0, 1, 2}, {0, 0, 0}, {0, 0, 0}};
  r.initial_displacement = r.initial_velocity = Points::Zero(3, 3);
  for (const double f : {1.0, 3.0}) {
    r.windows.push_back({1e-3 * static_cast<double>(r.windows.size()), 1e-3});
    r.displacement.push_back(Points::Zero(3, 3));
    r.velocity.push_back(Points::Zero(3, 3));
    r.force.push_back(Points::Constant(3, 3, f));
  }
  return r;
}

Setup partner(const Points& position) {
  Setup setup;
  setup.partner_mesh.name = "structure";
  setup.partner_mesh.position = position;
  return setup;
}

TEST(FluidReplay, KeepsTheImpulseWhenWindowsDiffer) {
  Replay replay(record(), "runs/x", partner(record().mesh.position));
  const Advanced whole = replay.advance({0, 1e-3}, {}), across = replay.advance({0.5e-3, 1e-3}, {});
  EXPECT_EQ(whole.output.at(0).quantity, "force");
  EXPECT_TRUE(whole.output.at(0).conservative);
  EXPECT_NEAR(whole.output.at(0).value(1, 1), 1, 1e-12);
  EXPECT_NEAR(across.output.at(0).value(1, 1), 2, 1e-12);
}

TEST(FluidReplay, RefusesOtherPointsAndTimeBeyondTheRecord) {
  EXPECT_THROW(Replay(record(), "runs/x", partner(Points::Zero(3, 2))), Error);
  EXPECT_THROW(Replay(record(), "runs/x", partner(record().mesh.position.array() + 1e-3)), Error);
  Replay replay(record(), "runs/x", partner(record().mesh.position));
  EXPECT_THROW(replay.advance({1.5e-3, 1e-3}, {}), Error);
}

}  // namespace
}  // namespace strake::fluid
