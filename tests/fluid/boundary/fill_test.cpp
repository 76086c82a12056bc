#include "fluid/boundary/fill.hpp"

#include "fluid/mps/number_density.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace strake::fluid {
namespace fill_test {

Parameters paper_tank() {
  Parameters parameters;
  parameters.tank = {{-1.0, -0.5, 0}, {1.0, 0.5, 0}};
  parameters.water = {{-1.0, -0.5, 0}, {1.0, 0.0, 0}};
  return parameters;
}

template <class Change>
std::string error_of(Change&& change) {
  auto parameters = paper_tank();
  change(parameters);
  try {
    fill<2>(parameters);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_FALSE(error.fix().empty());
    return to_text(error);
  }
  return "no error";
}

TEST(Fill, the_papers_tank_has_ten_thousand_water_particles_at_cell_centres) {
  const auto state = fill<2>(paper_tank());
  const auto count = [&](Kind kind) { return std::count(state.kind.begin(), state.kind.end(), kind); };
  EXPECT_EQ(count(Kind::fluid), 10000);
  EXPECT_EQ(count(Kind::wall), 202 + 2 * 100);            // floor with its corners, two sides
  EXPECT_EQ(count(Kind::dummy_wall), 3 * 208 + 6 * 101);  // three layers behind: floor, both sides
  EXPECT_NEAR(state.position(0, 0), -0.995, 1e-12);
  EXPECT_NEAR(state.position(1, 0), -0.495, 1e-12);
  EXPECT_NEAR(state.position.leftCols(10000).row(1).maxCoeff(), -0.005, 1e-12);
  EXPECT_NEAR(state.position.row(1).maxCoeff(), 0.495, 1e-12);
  EXPECT_NEAR(state.position.row(1).minCoeff(), -0.535, 1e-12);
  EXPECT_EQ(state.velocity.norm(), 0);
}

TEST(Fill, water_and_wall_rows_below_the_surface_have_full_support) {
  const auto parameters = paper_tank();
  const auto state = fill<2>(parameters);
  NeighbourSearch<2> search(0.031, 0);
  const auto n = number_density(search.update(state.position), 0.031);
  const double n0 = lattice_constants<2>(3.1, 0.01).n0;
  for (Eigen::Index i = 0; i < n.size(); ++i)
    if (has_pressure(state.kind[static_cast<std::size_t>(i)]) && state.position(1, i) < -0.04) {
      ASSERT_NEAR(n[i], n0, 1e-9 * n0) << state.position.col(i).transpose();
    }
}

TEST(Fill, dummy_rows_reach_as_far_as_the_largest_radius) {
  Scheme scheme;
  for (const auto& [radius, rows] :
       {std::pair{2.1, 2}, std::pair{3.1, 3}, std::pair{4.0, 3}, std::pair{4.1, 4}}) {
    scheme.radius_laplacian = radius;
    EXPECT_EQ(dummy_rows(scheme), rows) << radius;
  }
}

TEST(Fill, a_box_in_space_is_filled_with_five_walls) {
  Parameters parameters;
  parameters.dimension = 3;
  parameters.spacing = 0.1;
  parameters.tank = {{0, 0, 0}, {1, 1, 0.6}};
  parameters.water = {{0, 0, 0}, {1, 0.5, 0.6}};
  parameters.scheme.radius_laplacian = 2.1;
  const auto state = fill<3>(parameters);
  const auto count = [&](Kind kind) { return std::count(state.kind.begin(), state.kind.end(), kind); };
  EXPECT_EQ(count(Kind::fluid), 10 * 5 * 6);
  EXPECT_EQ(count(Kind::wall), 12 * 11 * 8 - 10 * 10 * 6);
  EXPECT_EQ(count(Kind::dummy_wall), 16 * 13 * 12 - 12 * 11 * 8);
}

TEST(Fill, a_box_off_the_lattice_is_refused_with_the_nearest_that_fits) {
  const auto water = error_of([](Parameters& p) { p.water.max[1] = -0.003; });
  EXPECT_NE(water.find("fluid.water"), std::string::npos) << water;
  EXPECT_NE(water.find("nearest is 0 m"), std::string::npos) << water;
  const auto tank = error_of([](Parameters& p) { p.tank.max[0] = 1.0005; });
  EXPECT_NE(tank.find("fluid.tank"), std::string::npos) << tank;
}

TEST(Fill, water_outside_the_tank_is_refused) {
  const auto text = error_of([](Parameters& p) { p.water.max[0] = 1.2; });
  EXPECT_NE(text.find("fluid.water"), std::string::npos) << text;
  EXPECT_NE(text.find("inside fluid.tank"), std::string::npos) << text;
}

TEST(Fill, a_spacing_too_coarse_for_the_depth_is_refused) {
  const auto text = error_of([](Parameters& p) { p.spacing = 0.25; });
  EXPECT_NE(text.find("fluid.spacing"), std::string::npos) << text;
}

}  // namespace fill_test
}  // namespace strake::fluid
