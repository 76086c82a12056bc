#include "structure/body/beam.hpp"

#include <gtest/gtest.h>

namespace strake::structure {
namespace beam_test {

// cases/VALIDATION.md, "Strips: deflection and frequencies", plane strain; printed there to 0.01 Hz.
struct Row {
  Support left, right;
  double f1, f2, f3, timoshenko;
};

TEST(Beam, FrequenciesAreThoseOfTheTableForEverySupport) {
  for (const Row& row : {Row{Support::clamped, Support::clamped, 698.89, 1926.53, 3776.76, 686.03},
                         Row{Support::pinned, Support::pinned, 308.31, 1233.22, 2774.75, 306.91},
                         Row{Support::clamped, Support::free, 109.83, 688.31, 1927.29, 109.60},
                         Row{Support::clamped, Support::pinned, 481.63, 1560.79, 3256.47, 0}}) {
    const Plate plate{.length = 0.4, .thickness = 0.02, .left = row.left, .right = row.right};
    const std::vector<double> f = beam_frequencies(plate, Material{}, BeamTheory::euler_bernoulli, 3);
    ASSERT_EQ(f.size(), 3u);
    EXPECT_NEAR(f[0], row.f1, 0.02);
    EXPECT_NEAR(f[1], row.f2, 0.05);
    EXPECT_NEAR(f[2], row.f3, 0.05);
    if (row.timoshenko > 0) {
      EXPECT_NEAR(beam_frequencies(plate, Material{}, BeamTheory::timoshenko, 1).at(0), row.timoshenko, 0.02);
    }
  }
}

TEST(Beam, FreePlateLeavesItsRigidMotionsOut) {
  const Plate plate{.length = 0.4, .thickness = 0.02};  // free-free has the roots of clamped-clamped
  EXPECT_NEAR(beam_frequencies(plate, Material{}, BeamTheory::euler_bernoulli, 1).at(0), 698.89, 0.02);
}

}  // namespace beam_test
}  // namespace strake::structure
