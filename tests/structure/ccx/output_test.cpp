// What CalculiX writes, as it is read back; without CalculiX.
#include "structure/ccx/output.hpp"

#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake::structure::ccx {
namespace {

const char* increment = R"(
 displacements (vx,vy,vz) for set WANTED and time  0.1000000E-04

         1  3.500000E-24  1.250000E-01-1.000000-102
         3  1.000000E+00  2.000000E+00  3.000000E+00

 velocities (vx,vy,vz) for set WANTED and time  0.1000000E-04

         1  0.000000E+00  6.000000E-03  0.000000E+00
         3  4.000000E+00  5.000000E+00 -6.000000E+00

 total internal energy for set BODY and time  0.1000000E-04

        1.100000E-04

 total kinetic energy for set BODY and time  0.1000000E-04

        7.400000E-04
)";

TEST(CalculixOutput, GivesTheWantedNodesInTheirOrder) {
  const TemporaryFolder folder;
  put(folder / "deck.dat", increment);
  const std::vector<Printed> all = read_printed(folder / "deck.dat", {0, 2}, 4);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].time, 1e-5);
  EXPECT_EQ(all[0].displacement.col(0), Eigen::Vector3d(3.5e-24, 0.125, -1e-102));
  EXPECT_EQ(all[0].velocity.col(1), Eigen::Vector3d(4, 5, -6));
  EXPECT_EQ(all[0].strain, 1.1e-4);
  EXPECT_EQ(all[0].kinetic, 7.4e-4);
}

TEST(CalculixOutput, DropsAnIncrementThatIsCutOff) {
  const TemporaryFolder folder;
  const std::string text = increment;
  put(folder / "deck.dat", text + text.substr(0, text.find(" velocities")));
  EXPECT_EQ(read_printed(folder / "deck.dat", {0, 2}, 4).size(), 1u);
  EXPECT_TRUE(read_printed(folder / "none.dat", {0, 2}, 4).empty());
}

TEST(CalculixOutput, GivesFieldsOfTheBody) {
  const TemporaryFolder folder;
  put(folder / "deck.frd", R"(    1C
    2C                             2                                     1
 -1         1 9.00000E+00 9.00000E+00 9.00000E+00
 -3
  100CL  101 2.00000E-05           2                     1    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1 1.00000E-03-2.00000E-03 0.00000E+00
 -1         2 0.00000E+00 4.00000E-03 0.00000E+00
 -3
  100CL  101 2.00000E-05           2                     1    1           1
 -4  STRESS      6    1
 -1         1 3.00000E+00 0.00000E+00 0.00000E+00 0.00000E+00 0.00000E+00 0.00000E+00
 -1         2 5.00000E+00 5.00000E+00 5.00000E+00 2.00000E+00 0.00000E+00 0.00000E+00
 -3
  100CL  101 2.00000E-05           2                     1    1           1
 -4  ERROR       1    1
 -1         1 3.00000E+01
 -3
)");
  const std::vector<BodyField> all = read_fields(folder / "deck.frd", 2);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].time, 2e-5);
  EXPECT_EQ(all[0].displacement.col(0), Eigen::Vector3d(1e-3, -2e-3, 0));
  EXPECT_DOUBLE_EQ(all[0].von_mises(0), 3);
  EXPECT_DOUBLE_EQ(all[0].von_mises(1), 2 * std::sqrt(3.0));
}

}  // namespace
}  // namespace strake::structure::ccx
