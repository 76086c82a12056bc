#include "fluid/particles/neighbours.hpp"

#include "proto/error.hpp"
#include "tests/fluid/lattice.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <random>

namespace strake::fluid {
namespace neighbours_test {

template <int dim>
std::vector<std::vector<std::int32_t>> every_pair(const Vectors<dim>& position, double radius,
                                                  const Periodic<dim>& periodic = {}) {
  std::vector<std::vector<std::int32_t>> rows(static_cast<std::size_t>(position.cols()));
  for (std::int32_t i = 0; i < position.cols(); ++i)
    for (std::int32_t j = 0; j < position.cols(); ++j)
      if (i != j && periodic.separation(position.col(i), position.col(j)).norm() < radius)
        rows[static_cast<std::size_t>(i)].push_back(j);
  return rows;
}

void expect_rows(const Neighbours& found, const std::vector<std::vector<std::int32_t>>& expected) {
  ASSERT_EQ(found.size(), static_cast<std::int64_t>(expected.size()));
  for (std::int64_t i = 0; i < found.size(); ++i) {
    const auto row = found.row(i);
    EXPECT_EQ(std::vector<std::int32_t>(row.begin(), row.end()), expected[static_cast<std::size_t>(i)]) << i;
  }
}

bool same(const Neighbours& a, const Neighbours& b) {
  return std::equal(a.start().begin(), a.start().end(), b.start().begin(), b.start().end()) &&
         std::equal(a.column().begin(), a.column().end(), b.column().begin(), b.column().end()) &&
         std::equal(a.inverse().begin(), a.inverse().end(), b.inverse().begin(), b.inverse().end());
}

template <int dim>
void jiggle(Vectors<dim>& position, double amount, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> shift(-amount, amount);
  for (Eigen::Index i = 0; i < position.size(); ++i) position.data()[i] += shift(generator);
}

TEST(Neighbours, rows_hold_exactly_the_pairs_within_the_radius_sorted_by_index) {
  const auto plane = block<2>(17, 0.01, 0.3);
  NeighbourSearch<2> in_plane(0.031, 0.002);
  expect_rows(in_plane.update(plane), every_pair<2>(plane, 0.031));
  const auto space = block<3>(8, 0.01, 0.3);
  NeighbourSearch<3> in_space(0.021, 0.002);
  expect_rows(in_space.update(space), every_pair<3>(space, 0.021));
}

TEST(Neighbours, a_skin_never_shows_in_the_rows) {
  auto position = block<2>(20, 0.01, 0.2);
  NeighbourSearch<2> with_skin(0.031, 0.002), without(0.031, 0.0);
  for (unsigned step = 0; step < 40; ++step) {
    const auto& a = with_skin.update(position);
    without.invalidate();
    const auto& b = without.update(position);
    ASSERT_TRUE(same(a, b)) << "step " << step;
    jiggle<2>(position, 1e-4, step);
  }
  EXPECT_LT(with_skin.rebuilds(), 20);
  EXPECT_GT(with_skin.rebuilds(), 1);
}

TEST(Neighbours, a_skin_too_thin_for_the_motion_is_left_out_and_taken_up_again) {
  auto position = block<2>(20, 0.01, 0.2);
  NeighbourSearch<2> search(0.031, 0.002), fresh(0.031, 0);
  const auto rebuilds_of = [&](double way, unsigned count) {
    const auto before = search.rebuilds();
    for (unsigned step = 0; step < count; ++step) {
      jiggle<2>(position, way, step);
      fresh.invalidate();
      EXPECT_TRUE(same(search.update(position), fresh.update(position)));
      EXPECT_TRUE(same(search.within(0.021), fresh.within(0.021)));
    }
    return search.rebuilds() - before;
  };
  search.update(position);
  EXPECT_EQ(rebuilds_of(2e-3, 10), 10);
  EXPECT_LT(rebuilds_of(5e-5, 20), 10);
}

TEST(Neighbours, parts_of_the_rows_follow_them_whether_known_before_an_update_or_not) {
  auto position = block<3>(8, 0.01, 0.2);
  NeighbourSearch<3> search(0.031, 0.002);
  for (unsigned step = 0; step < 4; ++step) {
    search.update(position);  // particles with more than 64 pairs
    expect_rows(search.within(0.021), every_pair<3>(position, 0.021));
    if (step > 1) expect_rows(search.within(0.027), every_pair<3>(position, 0.027));
    jiggle<3>(position, 5e-4, step);
  }
  search.update(position);
  expect_rows(search.within(0.031), every_pair<3>(position, 0.031));
}

TEST(Neighbours, pairs_are_symmetric_to_the_last_bit) {
  const auto position = block<2>(20, 0.01, 0.4);
  NeighbourSearch<2> search(0.031, 0.002);
  const auto& rows = search.update(position);
  for (std::int32_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < rows.row(i).size(); ++k) {
      const auto j = rows.row(i)[k];
      const auto back = std::lower_bound(rows.row(j).begin(), rows.row(j).end(), i) - rows.row(j).begin();
      ASSERT_LT(back, static_cast<std::ptrdiff_t>(rows.row(j).size()));
      ASSERT_EQ(rows.row(j)[static_cast<std::size_t>(back)], i);
      ASSERT_EQ(rows.distances(j)[static_cast<std::size_t>(back)], rows.distances(i)[k]);
      ASSERT_EQ(rows.inverses(j)[static_cast<std::size_t>(back)], rows.inverses(i)[k]);
    }
}

TEST(Neighbours, a_smaller_radius_gives_the_part_of_the_rows_within_it) {
  auto position = block<2>(15, 0.01, 0.3);
  NeighbourSearch<2> search(0.031, 0.002);
  search.update(position);
  expect_rows(search.within(0.021), every_pair<2>(position, 0.021));
  jiggle<2>(position, 3e-3, 1);
  search.update(position);
  expect_rows(search.within(0.021), every_pair<2>(position, 0.021));
  expect_rows(search.within(0.031), every_pair<2>(position, 0.031));
}

TEST(Neighbours, entries_say_the_same_distances_to_single_precision_alike_from_both_ends) {
  const double radius = 0.031, rounding = 4 * std::numeric_limits<float>::epsilon();
  const auto position = block<2>(20, 0.01, 0.4);
  NeighbourSearch<2> with_entries(radius, 0.002, {}, PairData::entries), with_inverses(radius, 0.002);
  const Neighbours &rows = with_entries.update(position), &exact = with_inverses.update(position);
  const Neighbours &near = with_entries.within(0.021), &exact_near = with_inverses.within(0.021);
  expect_rows(rows, every_pair<2>(position, radius));
  expect_rows(near, every_pair<2>(position, 0.021));
  ASSERT_EQ(rows.column().size(), exact.column().size());
  for (std::size_t e = 0; e < rows.entry().size(); ++e) {
    const double ratio = radius * exact.inverse()[e];
    EXPECT_NEAR(rows.entry()[e], 1 - ratio, rounding * ratio);
    EXPECT_LE(rows.entry()[e], 0);
  }
  for (std::int64_t e = 0; e < near.start().back(); ++e)
    EXPECT_NEAR(near.inverse_of(e), exact_near.inverse_of(e), rounding * exact_near.inverse_of(e));
  for (std::int32_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < rows.row(i).size(); ++k) {
      const auto j = rows.row(i)[k];
      const auto back = std::lower_bound(rows.row(j).begin(), rows.row(j).end(), i) - rows.row(j).begin();
      ASSERT_EQ(rows.entries(j)[static_cast<std::size_t>(back)], rows.entries(i)[k]);
    }
}

TEST(Neighbours, two_fillers_do_not_see_one_another) {
  const auto position = block<2>(10, 0.01);
  std::vector<std::uint8_t> tag(100, plain);
  for (std::size_t i = 0; i < 50; ++i) tag[i] = filler;
  NeighbourSearch<2> search(0.021, 0.002);
  const auto& rows = search.update(position, tag);
  for (std::int32_t i = 0; i < 50; ++i)
    for (const auto j : rows.row(i)) EXPECT_GE(j, 50);
  EXPECT_EQ(rows.row(55).size(), 12u);
  EXPECT_EQ(rows.row(45).size(), 4u);  // three in the row above it, one in the next
}

TEST(Neighbours, asked_pairs_are_kept_only_if_the_predicate_says_so_at_the_present_positions) {
  auto position = block<2>(12, 0.01, 0.2);
  std::vector<std::uint8_t> tag(144, plain);
  for (std::size_t i = 60; i < 84; ++i) tag[i] = asked;
  const auto apart = [&](std::int32_t i, std::int32_t j) {
    return (position(1, i) > 0) == (position(1, j) > 0);
  };
  NeighbourSearch<2> search(0.021, 0.004);
  for (unsigned step = 0; step < 5; ++step) {
    auto expected = every_pair<2>(position, 0.021);
    for (std::int32_t i = 0; i < 144; ++i)
      std::erase_if(expected[static_cast<std::size_t>(i)], [&](std::int32_t j) {
        return (tag[static_cast<std::size_t>(i)] | tag[static_cast<std::size_t>(j)]) == asked && !apart(i, j);
      });
    expect_rows(search.update(position, tag, apart), expected);
    jiggle<2>(position, 5e-4, step);
  }
}

TEST(Neighbours, a_particle_far_outside_costs_no_memory_and_changes_nothing_for_the_others) {
  auto position = block<2>(15, 0.01, 0.3);
  position.col(7) << 4.7e6, -3.1e8;
  position.col(9) << 4.7e6 + 0.01, -3.1e8;
  NeighbourSearch<2> search(0.031, 0.002);
  expect_rows(search.update(position), every_pair<2>(position, 0.031));
}

TEST(Neighbours, coincident_particles_do_not_see_one_another) {
  auto position = block<2>(5, 0.01);
  position.col(3) = position.col(12);
  NeighbourSearch<2> search(0.021, 0.002);
  const auto& rows = search.update(position);
  for (const double inverse : rows.inverse()) EXPECT_TRUE(std::isfinite(inverse));
  for (const auto j : rows.row(12)) EXPECT_NE(j, 3);
}

template <int dim>
Vectors<dim> anywhere(int count, const Vector<dim>& size, unsigned seed) {
  Vectors<dim> position(dim, count);
  std::mt19937 generator(seed);
  for (int i = 0; i < count; ++i)
    for (int d = 0; d < dim; ++d)
      position(d, i) = std::uniform_real_distribution<double>(0, size[d])(generator);
  return position;
}

template <int dim>
void expect_pairs_over_the_seam(const Vector<dim>& size, const Vector<dim>& length, double radius) {
  const Periodic<dim> periodic(length);
  auto position = anywhere<dim>(600, size, 3);
  NeighbourSearch<dim> search(radius, 0.05 * radius, periodic);
  for (unsigned step = 0; step < 6; ++step) {
    expect_rows(search.update(position), every_pair<dim>(position, radius, periodic));
    jiggle<dim>(position, 0.01 * radius, step);
    for (Eigen::Index i = 0; i < position.cols(); ++i)
      position.col(i) = periodic.wrap(position.col(i), Vector<dim>::Zero());
  }
  EXPECT_LT(search.rebuilds(), 6);  // a particle that is wrapped has not moved by a period
}

TEST(Neighbours, pairs_are_found_over_the_seams_of_periodic_directions) {
  expect_pairs_over_the_seam<2>({0.3, 0.2}, {0.3, 0}, 0.031);
  expect_pairs_over_the_seam<2>({0.3, 0.2}, {0, 0.2}, 0.031);
  expect_pairs_over_the_seam<2>({0.3, 0.2}, {0.3, 0.2}, 0.031);
  expect_pairs_over_the_seam<2>({0.0652, 0.2}, {0.0652, 0}, 0.031);  // no wider than it must be
  expect_pairs_over_the_seam<2>({0.098, 0.098}, {0.098, 0.098}, 0.031);
  expect_pairs_over_the_seam<3>({0.2, 0.1, 0.15}, {0.2, 0, 0.15}, 0.031);
  expect_pairs_over_the_seam<3>({0.066, 0.1, 0.066}, {0.066, 0, 0.066}, 0.031);
}

TEST(Neighbours, a_particle_parked_beyond_two_periods_sees_nobody) {
  auto position = anywhere<2>(100, {0.3, 0.2}, 5);
  position.col(40) << 0.75, 0.1;
  NeighbourSearch<2> search(0.031, 0.002, Periodic<2>({0.3, 0}));
  const auto& rows = search.update(position);
  EXPECT_TRUE(rows.row(40).empty());
}

TEST(Neighbours, a_period_shorter_than_twice_the_reach_is_an_error_of_the_case) {
  try {
    NeighbourSearch<2>(0.031, 0.002, Periodic<2>({0.065, 0}));
    FAIL() << "two images of one particle would be in reach";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_EQ(error.where(), "fluid.periodic");
    EXPECT_NE(error.problem().find("along x"), std::string::npos) << error.problem();
  }
}

TEST(Periodic, separation_takes_the_shortest_way_and_is_odd_to_the_last_bit) {
  const Periodic<2> periodic({0.7, 0});
  const auto position = anywhere<2>(200, {0.7, 5}, 11);
  for (Eigen::Index i = 0; i < 200; ++i)
    for (Eigen::Index j = 0; j < 200; ++j) {
      const Vector<2> r = periodic.separation(position.col(i), position.col(j));
      EXPECT_LE(std::abs(r[0]), 0.35);
      EXPECT_EQ(r[1], position(1, j) - position(1, i));
      EXPECT_EQ(r, -periodic.separation(position.col(j), position.col(i)));
    }
}

TEST(Periodic, wrap_puts_a_place_back_by_one_period) {
  const Periodic<3> periodic({2, 0, 1});
  EXPECT_EQ(periodic.wrap({3.5, 9, -0.25}, {1, 0, 0}), Vector<3>(1.5, 9, 0.75));
  EXPECT_EQ(periodic.wrap({3, -9, 1}, {1, 0, 0}), Vector<3>(1, -9, 0));
  EXPECT_EQ(Periodic<3>().wrap({7, 8, 9}, {0, 0, 0}), Vector<3>(7, 8, 9));
  EXPECT_FALSE(Periodic<3>().any());
}

TEST(Neighbours, a_position_that_is_not_finite_is_an_error_that_names_the_particle) {
  auto position = block<2>(5, 0.01);
  NeighbourSearch<2> search(0.021, 0.002);
  search.update(position);
  position(1, 17) = std::numeric_limits<double>::quiet_NaN();
  try {
    search.update(position);
    FAIL() << "not a number was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
    EXPECT_NE(error.problem().find("particle 17"), std::string::npos) << error.problem();
  }
}

TEST(Neighbours, rows_do_not_depend_on_the_number_of_threads) {
  const auto position = block<2>(60, 0.01, 0.3);
  NeighbourSearch<2> one(0.031, 0.002), two(0.031, 0.002);
  omp_set_num_threads(1);
  const auto& a = one.update(position);
  omp_set_num_threads(2);
  const auto& b = two.update(position);
  omp_set_num_threads(1);
  EXPECT_TRUE(same(a, b));
}

TEST(Neighbours, asked_pairs_do_not_depend_on_the_number_of_threads) {
  auto position = block<2>(90, 0.01, 0.3);
  std::vector<std::uint8_t> tag(static_cast<std::size_t>(position.cols()), plain);
  for (std::size_t i = 0; i < tag.size(); i += 7) tag[i] = i % 2 ? asked : filler;
  const auto apart = [&](std::int32_t i, std::int32_t j) {
    return (position(1, i) > 0) == (position(1, j) > 0);
  };
  NeighbourSearch<2> one(0.031, 0.002), several(0.031, 0.002), all(0.031, 0.002);
  for (unsigned step = 0; step < 3; ++step) {
    omp_set_num_threads(1);
    const auto& a = one.update(position, tag, apart);
    omp_set_num_threads(3);
    const auto& b = several.update(position, tag, apart);
    EXPECT_TRUE(same(a, b)) << step;
    EXPECT_LT(a.column().size(), all.update(position, tag).column().size());  // some were refused
    jiggle<2>(position, 3e-4, step);
    tag[8000] ^= filler;  // the candidates are found anew
  }
  omp_set_num_threads(1);
}

}  // namespace neighbours_test
}  // namespace strake::fluid
