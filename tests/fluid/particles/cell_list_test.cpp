#include "fluid/particles/cell_list.hpp"

#include "fluid/particles/neighbours.hpp"
#include "fluid/particles/running_sum.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <limits>
#include <random>

namespace strake::fluid {
namespace cell_list_test {

using std::size_t;
constexpr double l0 = 0.01, radius = 3.1 * l0, skin = 0.2 * l0;

/// A lattice of counts[d] particles along each direction.
template <int dim>
Vectors<dim> tank(const std::array<int, dim>& counts) {
  int all = 1;
  for (const int count : counts) all *= count;
  Vectors<dim> position(dim, all);
  for (int i = 0; i < all; ++i)
    for (int d = 0, rest = i; d < dim; ++d) {
      const int count = counts[static_cast<size_t>(d)];
      position(d, i) = (rest % count + 0.5) * l0;
      rest /= count;
    }
  return position;
}

template <int dim>
Candidates candidates(const Vectors<dim>& position, const Periodic<dim>& periodic = {}) {
  Candidates found;
  CellList<dim>().find(position, {}, radius, skin, periodic, found);
  return found;
}

/// Mean length of the list that a particle is compared with.
double mean_length(const Candidates& found) {
  double sum = 0;
  for (size_t i = 0; i < found.cell.size(); ++i)
    sum += static_cast<double>(found.list(static_cast<std::int64_t>(i)).size());
  return sum / static_cast<double>(found.cell.size());
}

TEST(CellList, words_of_bits_are_counted_beyond_32_bits) {
  // Three cells whose lists are longer than any memory: only where the bits would lie is computed.
  constexpr std::int64_t length = std::int64_t{1} << 35, words = length / 16;
  Candidates found;
  found.list_start = {0, length, 2 * length + 1, 2 * length + 18};
  found.cell = {0, 1, 2, 0, 1};
  EXPECT_EQ(place_bits(found), 4 * words + 2 + 2);
  const std::vector<std::int64_t> expected = {0, words, 2 * words + 1, 2 * words + 3, 3 * words + 3};
  EXPECT_EQ(found.bits_start, expected);
  EXPECT_EQ(found.first_bits(4), static_cast<size_t>(3 * words + 3));  // 6.4e9
}

TEST(CellList, numbers_of_cells_and_particles_stay_within_32_bits) {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(most_cells(1000), 16 * 1000 + 65536);
  EXPECT_EQ(most_cells(most), most);
  EXPECT_NO_THROW(check_count(most));
  try {
    check_count(most + 1);
    FAIL() << "a particle without a number";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_EQ(error.where(), "fluid.spacing");
    EXPECT_NE(error.problem().find("2 147 483 648"), std::string::npos) << error.problem();
  }
}

TEST(CellList, lists_of_a_long_tank_are_as_short_as_those_of_a_compact_one) {
  // 9 and 27 cells of at most 4 × 4 and 4 × 4 × 4 particles.
  EXPECT_LT(mean_length(candidates<2>(tank<2>({2, 8000}))), 9 * 16);
  EXPECT_LT(mean_length(candidates<2>(tank<2>({8000, 2}))), 9 * 16);
  EXPECT_LT(mean_length(candidates<3>(tank<3>({4000, 2, 2}))), 27 * 64);
  EXPECT_LT(mean_length(candidates<3>(tank<3>({2, 2, 4000}))), 27 * 64);
  EXPECT_LT(mean_length(candidates<3>(tank<3>({3000, 5, 15}))), 27 * 64);  // 200 widths
}

template <int dim>
void expect_harmless(Vectors<dim> position, const Vector<dim>& far) {
  const double alone = mean_length(candidates<dim>(position));
  for (const Eigen::Index thrown : {Eigen::Index{0}, position.cols() / 2}) {  // the first is in every sample
    Vectors<dim> with = position;
    with.col(thrown) = far;
    const Candidates found = candidates<dim>(with);
    EXPECT_LT(mean_length(found), 1.1 * alone);
    CellGrid<dim> grid;
    grid.lay(with, radius + skin, {});
    EXPECT_LE(grid.cells(), most_cells(with.cols()));
  }
}

TEST(CellList, a_far_particle_lengthens_no_list_and_takes_no_memory) {
  constexpr double way = 1e6 * 4000 * l0;
  expect_harmless<2>(tank<2>({8000, 2}), {way, 0});
  expect_harmless<2>(tank<2>({8000, 2}), {-way, way});
  expect_harmless<3>(tank<3>({4000, 2, 2}), {0, way, 0});
  expect_harmless<3>(tank<3>({4000, 2, 2}), {way, -way, way});
  expect_harmless<3>(tank<3>({4000, 2, 2}), {1e300, -1e300, 1e300});
  expect_harmless<3>(tank<3>({20, 20, 20}), {-way, 0, way});
}

TEST(CellList, rows_of_a_long_tank_with_a_far_particle_are_exact) {
  Vectors<3> position = tank<3>({700, 2, 1});
  position.col(3) << 1e9, -1e9, 1e9;
  position.col(900) << 1e9 + l0, -1e9, 1e9;
  NeighbourSearch<3> search(radius, skin);
  const Neighbours& rows = search.update(position);
  for (std::int64_t i = 0; i < position.cols(); ++i) {
    std::vector<std::int32_t> expected;
    for (std::int32_t j = 0; j < position.cols(); ++j)
      if (i != j && (position.col(i) - position.col(j)).norm() < radius) expected.push_back(j);
    ASSERT_TRUE(std::ranges::equal(rows.row(i), expected)) << i;
  }
}

TEST(CellList, cells_of_a_long_periodic_channel_grow_and_its_rows_stay_exact) {
  // The period has many more cells than are allowed; few particles near one another, and over the seam.
  constexpr double length = 3e7 * l0;
  const Periodic<2> periodic({length, 0});
  Vectors<2> position(2, 200);
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> near(0, 10 * l0);
  for (Eigen::Index i = 0; i < 200; ++i)
    position.col(i) << (i % 2 ? near(generator) : length - near(generator)), near(generator);
  CellGrid<2> grid;
  grid.lay(position, radius + skin, periodic);
  EXPECT_LE(grid.cells(), most_cells(200));
  NeighbourSearch<2> search(radius, skin, periodic);
  const Neighbours& rows = search.update(position);
  for (std::int64_t i = 0; i < 200; ++i) {
    std::vector<std::int32_t> expected;
    for (std::int32_t j = 0; j < 200; ++j)
      if (i != j && periodic.separation(position.col(i), position.col(j)).norm() < radius)
        expected.push_back(j);
    ASSERT_TRUE(std::ranges::equal(rows.row(i), expected)) << i;
  }
}

template <int dim>
Vectors<dim> scattered(int count, double extent) {
  Vectors<dim> position(dim, count);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> place(0, extent);
  for (Eigen::Index i = 0; i < position.size(); ++i) position.data()[i] = place(generator);
  return position;
}

template <int dim>
void expect_same_for_all_threads(const Vectors<dim>& position, const Periodic<dim>& periodic) {
  omp_set_num_threads(1);
  const Candidates one = candidates<dim>(position, periodic);
  for (std::int64_t i = 0; i < position.cols(); ++i) {
    const auto list = one.list(i);
    ASSERT_TRUE(std::ranges::is_sorted(list));
    ASSERT_TRUE(std::ranges::binary_search(list, static_cast<std::int32_t>(i)));
  }
  for (const int threads : {2, 3, 5, 16}) {
    omp_set_num_threads(threads);
    const Candidates several = candidates<dim>(position, periodic);
    EXPECT_EQ(several.lists, one.lists) << threads;
    EXPECT_EQ(several.list_start, one.list_start) << threads;
    EXPECT_EQ(several.cell, one.cell) << threads;
    EXPECT_EQ(several.bits_start, one.bits_start) << threads;
    EXPECT_EQ(several.bits, one.bits) << threads;
  }
  omp_set_num_threads(1);
}

TEST(CellList, lists_do_not_depend_on_the_number_of_threads) {
  expect_same_for_all_threads<2>(scattered<2>(9000, 0.9), {});
  expect_same_for_all_threads<3>(scattered<3>(9000, 0.2), {});
  expect_same_for_all_threads<3>(scattered<3>(9000, 0.2), Periodic<3>({0.2, 0, 0.2}));
  expect_same_for_all_threads<3>(scattered<3>(5, 0.2), {});
  expect_same_for_all_threads<2>(Vectors<2>(2, 0), {});
}

TEST(RunningSum, sums_are_those_of_one_thread_and_may_replace_their_sizes) {
  for (const int threads : {1, 2, 7}) {
    omp_set_num_threads(threads);
    for (const std::int64_t n : {0, 1, 5, 20000}) {
      std::vector<std::int64_t> size(static_cast<size_t>(n));
      for (std::int64_t i = 0; i < n; ++i) size[static_cast<size_t>(i)] = i % 5;
      std::vector<std::int64_t> expected = size;
      std::int64_t sum = 0;
      for (std::int64_t& value : expected) value = (sum += value);
      const std::int64_t total = running_sum(
          n, [&](std::int64_t i) { return size[static_cast<size_t>(i)]; },
          [&](std::int64_t i, std::int64_t from, std::int64_t to) {
            EXPECT_EQ(to - from, i % 5);
            size[static_cast<size_t>(i)] = to;
          });
      EXPECT_EQ(total, sum);
      EXPECT_EQ(size, expected);
    }
  }
  omp_set_num_threads(1);
}

}  // namespace cell_list_test
}  // namespace strake::fluid
