#include "fluid/size.hpp"

#include "fluid/boundary/fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace strake::fluid {
namespace size_test {

double water(const SizeEstimates& sizes) {
  return sizes[0].count;
}
double walls(const SizeEstimates& sizes) {
  return sizes[1].count;
}

template <int dim>
void expect_counted(const Parameters& p) {
  const auto state = fill<dim>(p);
  const auto made = static_cast<double>(std::count(state.kind.begin(), state.kind.end(), Kind::fluid));
  const double rest = static_cast<double>(state.kind.size()) - made;
  const SizeEstimates sizes = fluid::sizes(p);
  EXPECT_NEAR(water(sizes), made, 0.02 * made);
  EXPECT_NEAR(walls(sizes), rest, 0.1 * rest);
}

TEST(FluidSize, ParticlesAreCountedBeforeTheyAreMade) {
  Parameters plane;
  plane.tank = {{-1, -0.5, 0}, {1, 0.5, 0}};
  plane.water = {{-1, -0.5, 0}, {1, 0, 0}};
  expect_counted<2>(plane);
  plane.tank_polygon = {{-1, 0.5, 0}, {-1, -0.5, 0}, {1, -0.5, 0}, {1, 0.5, 0}};
  plane.water_shapes = {{{-1, -0.5, 0}, {0, -0.5, 0}, {0, 0, 0}, {-1, 0, 0}}};
  expect_counted<2>(plane);

  Parameters space;
  space.dimension = 3;
  space.spacing = 0.0125;
  space.tank = {{0, 0, 0}, {0.3, 0.4, 0.3}};
  space.water = {{0, 0, 0}, {0.3, 0.3, 0.3}};
  expect_counted<3>(space);
  space.periodic = {true, false, false};
  expect_counted<3>(space);
}

TEST(FluidSize, ACountBeyondAllIntegersIsANumber) {
  Parameters p;
  p.tank = {{-1, -0.5, 0}, {1, 0.5, 0}};
  p.water = {{-1, -0.5, 0}, {1, 0, 0}};
  p.spacing = 1e-9;
  EXPECT_NEAR(water(sizes(p)), 1e18, 1e12);
  EXPECT_EQ(sizes(p)[0].keys.front().path, "fluid.spacing");
}

}  // namespace size_test
}  // namespace strake::fluid
