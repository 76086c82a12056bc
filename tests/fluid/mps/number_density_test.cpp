#include "fluid/mps/number_density.hpp"

#include "tests/fluid/lattice.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace strake::fluid {
namespace number_density_test {

constexpr double l0 = 0.01;

template <int dim>
struct Block {
  int side;
  Vectors<dim> position;
  std::vector<Kind> kind;
  NeighbourSearch<dim> search;
  SurfaceTest test;
  explicit Block(int n, double radius = 2.1, double disorder = 0)
      : side(n),
        position(block<dim>(n, l0, disorder)),
        kind(static_cast<std::size_t>(position.cols()), Kind::fluid),
        search(std::max(radius, 2.1) * l0, 0) {
    test.spacing = l0;
    test.lattice = lattice_constants<dim>(radius, l0);
  }
  std::vector<std::uint8_t> flags(std::span<const std::uint8_t> previous = {}) {
    const auto& rows = search.update(position);
    return surface_flags<dim>(position, kind, rows, number_density(rows, test.lattice.radius), test,
                              previous);
  }
};

TEST(NumberDensity, inside_a_lattice_it_is_n0_and_in_a_flat_surface_row_the_share_of_the_table) {
  // n/n0 of the surface layer and of the layer beneath it (computed on the lattice), printed to three
  // decimals.
  const double table[][3] = {
      {1.8, 0.686, 1.000}, {2.1, 0.676, 0.992}, {3.1, 0.641, 0.918}, {4.1, 0.621, 0.863}};
  for (const auto& [radius, surface, second] : table) {
    Block<2> water(21, radius);
    const Eigen::VectorXd n =
        number_density(water.search.update(water.position), radius * l0) / water.test.lattice.n0;
    const int middle = 10;
    EXPECT_NEAR(n[21 * 10 + middle], 1.0, 1e-12);
    EXPECT_NEAR(n[21 * 20 + middle], surface, 0.6e-3);
    EXPECT_NEAR(n[21 * 19 + middle], second, 0.6e-3);
  }
}

TEST(NumberDensity, counts_are_those_of_the_lattice) {
  Block<2> water(15, 3.1);
  const auto counts = neighbour_counts(water.search.update(water.position), 3.1 * l0);
  EXPECT_EQ(counts[15 * 7 + 7], 28);
  EXPECT_EQ(neighbour_counts(water.search.update(water.position), 2.1 * l0)[15 * 7 + 7], 12);
}

TEST(SurfaceFlags, every_criterion_finds_the_outer_row_of_a_block_and_nothing_inside) {
  for (const auto second : {SecondCriterion::none, SecondCriterion::arc}) {
    Block<2> water(15);
    water.test.second = second;
    const auto first = water.flags();
    const auto again = water.flags(first);
    for (int y = 0; y < 15; ++y)
      for (int x = 0; x < 15; ++x) {
        const bool outer = x == 0 || y == 0 || x == 14 || y == 14;
        EXPECT_EQ(first[static_cast<std::size_t>(15 * y + x)], outer) << x << " " << y;
        EXPECT_EQ(again[static_cast<std::size_t>(15 * y + x)], outer) << x << " " << y;
      }
  }
}

TEST(SurfaceFlags, the_arc_test_leaves_the_second_row_alone_where_a_wide_radius_alone_would_flag_it) {
  Block<2> water(15, 3.1);
  const std::size_t second_row = 15 * 13 + 7;
  EXPECT_EQ(water.flags()[second_row], 1);
  water.test.second = SecondCriterion::arc;
  EXPECT_EQ(water.flags()[second_row], 0);
}

TEST(SurfaceFlags, in_space_the_outer_layer_is_surface_and_the_inside_is_not) {
  Block<3> water(9);
  water.test.second = SecondCriterion::arc;
  const auto flags = water.flags();
  const auto inside = interior<3>(9, 1);
  EXPECT_EQ(std::count(flags.begin(), flags.end(), 1), 9 * 9 * 9 - static_cast<std::int64_t>(inside.size()));
  for (const auto i : inside) EXPECT_EQ(flags[static_cast<std::size_t>(i)], 0);
}

TEST(SurfaceFlags, the_arc_test_does_not_make_a_surface_of_a_missing_particle) {
  Block<2> water(15);
  water.position.col(15 * 7 + 7) << 1.0, 1.0;
  const std::size_t beside = 15 * 7 + 8;
  EXPECT_EQ(water.flags()[beside], 1);  // n alone takes the hole for a surface
  water.test.second = SecondCriterion::arc;
  const std::vector<std::uint8_t> inner(225, 0);
  EXPECT_EQ(water.flags(inner)[beside], 0);
}

// A layer that approaches the surface from above closes it late. A crack of the same width between two layers
// of water opens late. Distances of layer centres in l0.
TEST(SurfaceFlags, a_crack_opens_wider_than_an_approaching_row_closes) {
  const auto gap = [](double distance, bool before) {
    Block<2> water(20);
    water.test.second = SecondCriterion::arc;
    for (Eigen::Index i = 200; i < 400; ++i) water.position(1, i) += (distance - 1) * l0;
    const std::vector<std::uint8_t> previous(400, before ? 1 : 0);
    return water.flags(previous)[20 * 9 + 10] != 0;
  };
  EXPECT_TRUE(gap(1.25, true));
  EXPECT_FALSE(gap(1.1, true));
  EXPECT_FALSE(gap(1.8, false));
  EXPECT_TRUE(gap(2.05, false));
}

TEST(SurfaceFlags, dummies_are_never_surface_and_a_dry_wall_row_is) {
  Block<2> tank(9);
  tank.test.second = SecondCriterion::arc;
  // Three layers of tank floor, the lower two dummies, nothing above.
  for (Eigen::Index i = 27; i < 81; ++i) tank.position(1, i) += 1.0;
  for (std::size_t i = 0; i < 18; ++i) tank.kind[i] = Kind::dummy_wall;
  for (std::size_t i = 18; i < 27; ++i) tank.kind[i] = Kind::wall;
  const auto flags = tank.flags();
  for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(flags[i], 0);
  EXPECT_EQ(flags[22], 1);
}

}  // namespace number_density_test
}  // namespace strake::fluid
