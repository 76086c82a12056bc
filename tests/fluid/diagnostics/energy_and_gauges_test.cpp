#include "fluid/diagnostics/energy_and_gauges.hpp"

#include "fluid/diagnostics/volume.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace strake::fluid {
namespace energy_and_gauges_test {

/// Lattice points of a box nx × ny (× nz) whose lower corner is the origin.
template <int dim>
Vectors<dim> box(const std::array<int, 3>& n, double l0) {
  Vectors<dim> points(dim, n[0] * n[1] * (dim == 3 ? n[2] : 1));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const std::array<Eigen::Index, 3> cell{k % n[0], (k / n[0]) % n[1], k / (n[0] * n[1])};
    for (int d = 0; d < dim; ++d)
      points(d, k) = (static_cast<double>(cell[static_cast<std::size_t>(d)]) + 0.5) * l0;
  }
  return points;
}

std::vector<std::int64_t> all(Eigen::Index n) {
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(n));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

constexpr double l0 = 0.02;

TEST(WaterVolume, a_box_of_a_lattice_has_the_volume_of_its_particles) {
  EXPECT_NEAR(water_volume<2>(box<2>({40, 20, 1}, l0), l0), 40 * 20 * l0 * l0, 1e-12);
  EXPECT_NEAR(water_volume<3>(box<3>({12, 10, 8}, l0), l0), 12 * 10 * 8 * l0 * l0 * l0,
              0.015 * 960 * l0 * l0 * l0);
}

TEST(WaterVolume, turning_or_scattering_the_water_changes_its_volume_by_less_than_a_percent) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> scatter(-0.2 * l0, 0.2 * l0);
  const double exact = 60 * 40 * l0 * l0;
  for (const double angle : {0.0, 0.2, 0.5, 0.785}) {
    const Eigen::Rotation2Dd turn(angle);
    Vectors<2> points = turn.toRotationMatrix() * box<2>({60, 40, 1}, l0);
    EXPECT_NEAR(water_volume<2>(points, l0), exact, 0.005 * exact) << angle;
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      points.col(k) += Vector<2>(scatter(random), scatter(random));
    EXPECT_NEAR(water_volume<2>(points, l0), exact, 0.01 * exact) << angle;
  }
}

TEST(WaterVolume, a_hole_counts_as_soon_as_a_circle_of_the_support_fits_in) {
  Vectors<2> points = box<2>({41, 41, 1}, l0);
  const Vector<2> middle = points.col(20 * 41 + 20);
  const double whole = water_volume<2>(points, l0);
  const auto without = [&](double radius) {
    Vectors<2> left = points;
    Eigen::Index n = 0;
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      if ((points.col(k) - middle).norm() > radius) left.col(n++) = points.col(k);
    return water_volume<2>(left.leftCols(n), l0);
  };
  EXPECT_EQ(without(0.5 * l0), whole);  // one particle is missing: no more than a coarse place
  // 21 particles are missing, and l0/2 of the circle of 3 l0 to the next ones belongs to those.
  const double lost = whole - without(2.5 * l0);
  EXPECT_GT(lost, 12 * l0 * l0);
  EXPECT_LT(lost, 25 * l0 * l0);
}

TEST(WaterVolume, drops_far_from_one_another_add_up) {
  Vectors<2> drops(2, 3);
  drops << 0, 1.3, 2.1, 0, 0.4, 3.7;
  EXPECT_NEAR(water_volume<2>(drops, l0), 3 * l0 * l0, 0.3 * l0 * l0);
  EXPECT_EQ(water_volume<2>(Vectors<2>(2, 0), l0), 0);
}

TEST(Front, is_the_end_of_the_water_on_the_floor_and_not_a_drop_ahead_of_it) {
  Vectors<2> points = box<2>({30, 10, 1}, l0);
  EXPECT_NEAR(front<2>(points, all(300), Vector<2>(0, 0), l0), 30 * l0, 1e-12);
  points.conservativeResize(2, 302);
  points.col(300) = Vector<2>(33 * l0, 0.5 * l0);  // a drop on the floor, 3 l0 ahead
  points.col(301) = Vector<2>(31 * l0, 5.5 * l0);  // water that overhangs
  EXPECT_NEAR(front<2>(points, all(302), Vector<2>(0, 0), l0), 30 * l0, 1e-12);
  EXPECT_EQ(front<2>(points, all(302), Vector<2>(2, 0), l0), 2);  // no water there
}

TEST(Level, is_the_highest_water_without_a_gap_below_it) {
  Vectors<2> points = box<2>({30, 10, 1}, l0);
  const Vector<2> floor(10 * l0, 0);
  EXPECT_NEAR(level<2>(points, all(300), floor, l0), 10 * l0, 1e-12);
  points.conservativeResize(2, 301);
  points.col(300) = Vector<2>(10 * l0, 15 * l0);  // spray
  EXPECT_NEAR(level<2>(points, all(301), floor, l0), 10 * l0, 1e-12);
  EXPECT_EQ(level<2>(points, all(301), Vector<2>(100 * l0, 0), l0), 0);
}

TEST(WettedHeight, of_a_lattice_is_its_height_at_any_place_and_at_the_walls) {
  const Vectors<2> points = box<2>({30, 10, 1}, l0);
  const Vector<2> low(0, 0), high(30 * l0, 1);
  for (const double x : {0.0, 0.3, 5.1, 14.77, 29.9, 30.0})
    EXPECT_NEAR(wetted_height<2>(points, all(300), Vector<2>(x * l0, 0), low, high, l0), 10 * l0,
                0.07 * 10 * l0)
        << x;
  for (const double x : {0.0, 5.1, 14.77, 30.0})
    EXPECT_NEAR(wetted_height<2>(points, all(300), Vector<2>(x * l0, 0), low, high, l0), 10 * l0, 1e-12) << x;
  const Vectors<3> deep = box<3>({10, 5, 8}, l0);
  EXPECT_NEAR(wetted_height<3>(deep, all(400), Vector<3>(5 * l0, 0, 3.3 * l0), Vector<3>(0, 0, 0),
                               Vector<3>(10 * l0, 1, 8 * l0), l0),
              5 * l0, 1e-12);
}

TEST(WaterAccount, falling_water_turns_its_potential_into_kinetic_energy) {
  State<2> state;
  state.position = box<2>({10, 10, 1}, l0);
  state.velocity = Vectors<2>::Zero(2, 100);
  state.surface.assign(100, 0);
  state.surface[3] = 1;
  const double mass = 1000 * l0 * l0, t = 0.1;
  const Vector<2> gravity(0, -9.81), corner(0, -1);
  const auto start = account_of<2>(state, all(100), mass, gravity, corner);
  EXPECT_NEAR(start.potential, 100 * mass * 9.81 * (1 + 5 * l0), 1e-9);
  EXPECT_EQ(start.kinetic, 0);
  EXPECT_EQ(start.surface, 1);
  EXPECT_EQ(start.inner, 99);
  EXPECT_LT((start.centre - Vector<2>(5 * l0, 5 * l0)).norm(), 1e-12);
  state.position.colwise() += Vector<2>(0.5 * t * t * gravity);
  state.velocity.colwise() += Vector<2>(t * gravity);
  const auto end = account_of<2>(state, all(100), mass, gravity, corner);
  EXPECT_NEAR(end.kinetic + end.potential, start.potential, 1e-9);
  EXPECT_NEAR(end.largest_speed, 0.981, 1e-12);
}

/// Scattered water in parts along x, each with what is within 2 l0 of it. Returns how often a part was asked
/// for each cell.
template <int dim>
double expect_parts_add_up(const std::array<int, 3>& n) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> scatter(-0.4 * l0, 0.4 * l0);
  Vectors<dim> points = box<dim>(n, l0);
  for (double& at : points.reshaped()) at += scatter(random);
  std::int64_t cells = 0, asked = 0;
  for (const auto& [from, to] : {std::pair{-1.0, 3.3 * l0}, {3.3 * l0, 4.05 * l0}, {4.05 * l0, 100.0}}) {
    std::vector<Eigen::Index> near;
    for (Eigen::Index k = 0; k < points.cols(); ++k)
      if (points(0, k) > from - 2.01 * l0 && points(0, k) < to + 2.01 * l0) near.push_back(k);
    VolumePart<dim> part;
    part.low = points.rowwise().minCoeff();
    part.counts = [&, from = from, to = to](const Vector<dim>& first,
                                            const Vector<dim>& last) -> std::optional<bool> {
      ++asked;
      const bool begins = first[0] >= from && first[0] < to, ends = last[0] >= from && last[0] < to;
      if (begins == ends && (begins || last[0] < from || first[0] >= to)) return begins;
      return std::nullopt;
    };
    const std::int64_t own = water_cells<dim>(Vectors<dim>(points(Eigen::all, near)), l0, part);
    EXPECT_GT(own, 0);
    cells += own;
  }
  EXPECT_EQ(volume_of_cells<dim>(cells, l0), water_volume<dim>(points, l0));
  return static_cast<double>(asked) / static_cast<double>(cells);
}

TEST(WaterVolume, the_parts_of_ranks_add_up_to_the_last_cell) {
  expect_parts_add_up<2>({19, 11, 1});
  EXPECT_LT(expect_parts_add_up<2>({200, 5, 1}), 0.125) << "stretches are asked for, not cells";
  expect_parts_add_up<3>({12, 7, 6});
  EXPECT_TRUE(std::isnan(volume_of_cells<2>(-1, l0)));
}

TEST(Gauges, read_nothing_of_what_is_left_out_on_ranks) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.2, 0.2);
  Vectors<3> points(3, 4000);
  for (double& at : points.reshaped()) at = place(random);
  const Vector<3> at(0.03, -0.02, 0.01), low(-0.2, -0.2, -0.2), high(0.2, 0.2, 0.2);
  const auto read = [&](const std::string& quantity, const std::vector<std::int64_t>& water) {
    if (quantity == "front") return front<3>(points, water, at, l0);
    if (quantity == "level") return level<3>(points, water, at, l0);
    return wetted_height<3>(points, water, at, low, high, l0);
  };
  for (const std::string quantity : {"front", "level", "height"}) {
    std::vector<std::int64_t> near = all(points.cols());
    std::erase_if(
        near, [&](std::int64_t i) { return !gauge_reads<3>(quantity, Vector<3>(points.col(i) - at), l0); });
    EXPECT_LT(near.size(), 1000U) << quantity;
    EXPECT_EQ(read(quantity, near), read(quantity, all(points.cols()))) << quantity;
  }
}

}  // namespace energy_and_gauges_test
}  // namespace strake::fluid
