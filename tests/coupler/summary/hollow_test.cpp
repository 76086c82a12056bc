// What is said of the resolution of hollow plates.
#include "coupler/summary/resolution.hpp"
#include "tests/coupler/summary/rigid_in_tank.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace strake {
namespace hollow_test {

// The edges meet the water first: it runs to the middle, and no jet leaves the face.
TEST(Resolution, AHollowPlateHasNoJet) {
  constexpr int n = 20;
  for (const double depth : {0.01, 0.05, -0.02}) {
    InterfaceMesh plate;
    plate.dimension = 2;
    plate.position = Points::Zero(3, n + 3);
    plate.faces.resize(2, n + 3);
    for (int k = 0; k <= n; ++k) {
      const double x = -0.2 + 0.4 * k / n;
      plate.position.col(k) << x, -depth * 25 * x * x, 0;
    }
    plate.position.col(n + 1) << 0.2, 0.06, 0;
    plate.position.col(n + 2) << -0.2, 0.06, 0;
    plate.position.row(1).array() -= plate.position.row(1).minCoeff();
    for (int k = 0; k < n + 3; ++k) plate.faces.col(k) << k, (k + 1) % (n + 3);
    Points velocity = Points::Zero(3, n + 3);
    velocity.row(1).setConstant(-6);
    CaseView view = case_with(0.01, 0.02);
    const auto lines = resolution_lines(view, plate, velocity);
    EXPECT_EQ(says(lines, "through the jet"), depth < 0) << depth << ": " << lines.at(0);
    EXPECT_EQ(says(lines, "mean force to some 15 %, to 5 % from 30 on"), depth > 0) << lines.at(0);
    view.value["fluid.air.layer"] = "true";
    EXPECT_EQ(says(resolution_lines(view, plate, velocity), "through the jet"), depth < 0);
  }
}

}  // namespace hollow_test
}  // namespace strake
