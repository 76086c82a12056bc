#include "fluid/particles/kernel.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace kernel_test {

struct Row {
  double radius, n0, lambda;
  int neighbours;
};

// The table of fluid/THEORY.md, section 3, printed there to six decimals.
constexpr double half_digit = 0.5e-6;

TEST(LatticeConstants, square_lattice_gives_the_table_to_all_its_digits) {
  for (const Row& row : {Row{1.8, 4.291169, 1.254282, 8}, Row{2.0, 5.656854, 1.292893, 8},
                         Row{2.1, 6.539697, 1.388351, 12}, Row{2.4, 9.774726, 1.770787, 20},
                         Row{2.6, 12.255953, 1.992341, 20}, Row{3.1, 18.976417, 2.448472, 28},
                         Row{4.0, 35.609223, 3.707100, 44}, Row{4.1, 37.699453, 3.843746, 48}}) {
    const auto constants = lattice_constants<2>(row.radius, 1.0);
    EXPECT_NEAR(constants.n0, row.n0, 1.01 * half_digit) << "r_e = " << row.radius;
    EXPECT_NEAR(constants.lambda0, row.lambda, 1.01 * half_digit) << "r_e = " << row.radius;
    EXPECT_EQ(constants.neighbours, row.neighbours) << "r_e = " << row.radius;
  }
}

TEST(LatticeConstants, cubic_lattice_gives_the_table_to_all_its_digits) {
  for (const Row& row :
       {Row{1.8, 8.387350, 1.465128, 0}, Row{2.0, 12.208167, 1.609901, 0}, Row{2.1, 14.418575, 1.701738, 0},
        Row{2.4, 22.809304, 2.103626, 0}, Row{2.6, 30.851439, 2.506493, 0}, Row{3.1, 54.321209, 3.243422, 0},
        Row{4.0, 123.991565, 5.211991, 0}, Row{4.1, 133.491354, 5.409332, 0}}) {
    const auto constants = lattice_constants<3>(row.radius, 1.0);
    EXPECT_NEAR(constants.n0, row.n0, 1.01 * half_digit) << "r_e = " << row.radius;
    EXPECT_NEAR(constants.lambda0, row.lambda, 1.01 * half_digit) << "r_e = " << row.radius;
  }
}

TEST(LatticeConstants, scale_with_the_spacing) {
  const auto unit = lattice_constants<2>(3.1, 1.0), small = lattice_constants<2>(3.1, 0.01);
  EXPECT_NEAR(small.n0, unit.n0, 1e-12 * unit.n0);
  EXPECT_NEAR(small.lambda0, 1e-4 * unit.lambda0, 1e-16);
  EXPECT_DOUBLE_EQ(small.radius, 0.031);
}

TEST(Weight, is_zero_at_and_beyond_the_radius_and_at_the_particle_itself) {
  EXPECT_EQ(weight(2.1, 2.1), 0);
  EXPECT_EQ(weight(5.0, 2.1), 0);
  EXPECT_EQ(weight(0.0, 2.1), 0);
  EXPECT_DOUBLE_EQ(weight(1.0, 2.1), 1.1);
}

}  // namespace kernel_test
}  // namespace strake::fluid
