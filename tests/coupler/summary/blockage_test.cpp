#include "coupler/summary/blockage.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace strake {
namespace blockage_test {

// Images in walls and floor, as dipoles far away: π²a²/24W² and π²a²/48H². A plate in a corner of thin water
// has no room.
TEST(Blockage, IsThatOfImagesInWallsAndFloor) {
  const double far = std::numeric_limits<double>::infinity(), pi2 = std::numbers::pi * std::numbers::pi;
  EXPECT_EQ(blockage(1, far, far, far), 0);
  EXPECT_NEAR(blockage(1, 20, 20, far), pi2 / 24 / 400, 1e-5);
  EXPECT_NEAR(blockage(1, 20, far, far), pi2 / 48 / 400, 1e-5);
  EXPECT_NEAR(blockage(1, 4, 4, 4), 0.0268 + 0.0129, 1e-4);
  EXPECT_NEAR(blockage(1, far, far, 0.1), 4 / (3 * std::numbers::pi) * 10, 1e-12);
  EXPECT_EQ(blockage(1, 1, far, far), far);
}

// A share s of a plate's added mass, in far walls, is 5/3 s of a wedge's impulse and 10/3 s of its force: its
// wetted width grows faster. Walls that the water reaches leave it no room.
TEST(Blockage, OfAWedgeCountsTheWaterThatRisesFaster) {
  const double far = std::numeric_limits<double>::infinity(), pi2 = std::numbers::pi * std::numbers::pi;
  EXPECT_EQ(blockage_of_entry(1, far, far, far).force, 0);
  EXPECT_NEAR(blockage_of_entry(1, 20, 20, far).impulse, 5 * pi2 / 72 / 400, 1e-5);
  EXPECT_NEAR(blockage_of_entry(1, 20, 20, far).force, 10 * pi2 / 72 / 400, 2e-5);
  EXPECT_NEAR(blockage_of_entry(1, far, far, 20).force, 10 * pi2 / 144 / 400, 1e-5);
  EXPECT_NEAR(blockage_of_entry(1, 2, 2, far).impulse, 0.2359, 1e-4);
  EXPECT_NEAR(blockage_of_entry(1, 2, 2, far).force, 0.5662, 1e-4);
  EXPECT_NEAR(blockage_of_entry(1, far, far, 1).impulse, 0.3115, 1e-3);
  EXPECT_NEAR(blockage_of_entry(1, far, far, 1).force, 0.5936, 1e-3);
  EXPECT_EQ(blockage_of_entry(1, 1.27, 1.27, far).force, far) << "W < 4/pi";
}

}  // namespace blockage_test
}  // namespace strake
