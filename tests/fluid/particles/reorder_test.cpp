#include "fluid/particles/reorder.hpp"

#include "fluid/particles/columns.hpp"
#include "fluid/particles/neighbours.hpp"
#include "fluid/simulation/simulation.hpp"
#include "tests/fluid/lattice.hpp"
#include "tests/fluid/plate_case.hpp"
#include "tests/fluid/same_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <type_traits>

namespace strake::fluid {
namespace reorder_test {

std::vector<std::int32_t> shuffled(std::int64_t n) {
  std::vector<std::int32_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  return order;
}

template <int dim>
double mean_distance_in_memory(const Vectors<dim>& x, double radius) {
  NeighbourSearch<dim> search(radius, 0);
  const Neighbours& rows = search.update(x);
  double sum = 0;
  for (std::int64_t i = 0; i < rows.size(); ++i)
    for (const auto j : rows.row(i)) sum += std::abs(static_cast<double>(j - i));
  return sum / static_cast<double>(rows.column().size());
}

TEST(Reorder, neighbours_come_near_in_memory_and_nobody_is_lost) {
  const auto plane = block<2>(60, 0.01, 0.2);
  const Vectors<2> mixed = plane(Eigen::all, shuffled(plane.cols()));
  auto order = cell_order<2>(mixed, 0.033);
  const Vectors<2> sorted = mixed(Eigen::all, order);
  EXPECT_LT(mean_distance_in_memory<2>(sorted, 0.031), 0.25 * mean_distance_in_memory<2>(mixed, 0.031));
  EXPECT_LT(mean_distance_in_memory<2>(sorted, 0.031), 1.5 * mean_distance_in_memory<2>(plane, 0.031));
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(order[k], static_cast<std::int32_t>(k));
  const auto space = block<3>(16, 0.01, 0.2);
  const Vectors<3> mixed_space = space(Eigen::all, shuffled(space.cols()));
  const Vectors<3> sorted_space = mixed_space(Eigen::all, cell_order<3>(mixed_space, 0.033));
  EXPECT_LT(mean_distance_in_memory<3>(sorted_space, 0.021),
            0.3 * mean_distance_in_memory<3>(mixed_space, 0.021));
}

TEST(Reorder, what_is_in_order_stays_as_it_is) {
  auto x = block<2>(40, 0.01, 0.2);
  x.col(7) << 3e9, -4e12;  // far flyers belong to the last cells
  x = Vectors<2>(x(Eigen::all, cell_order<2>(x, 0.033)));
  const auto again = cell_order<2>(x, 0.033);
  EXPECT_TRUE(std::is_sorted(again.begin(), again.end()));
}

TEST(Reorder, every_column_of_the_state_goes_along_and_those_behind_the_water_stay) {
  constexpr Eigen::Index n = 90, water = 70;
  State<2> state;
  resize_particles(state, n);
  const auto number = [](const char*, auto& column) {
    for (Eigen::Index k = 0; k < std::ssize(column); ++k)
      column.data()[k] = static_cast<std::remove_reference_t<decltype(*column.data())>>(k + 1);
  };
  for_each_column(number, state);
  const State<2> before = state;
  const auto order = shuffled(water);
  reorder(state, std::span<const std::int32_t>(order));
  const auto check = [&](const char* name, const auto& now, const auto& then) {
    const auto entries = std::ssize(now) / n;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index from = k < water ? order[static_cast<std::size_t>(k)] : k;
      for (auto d = 0 * entries; d < entries; ++d)
        EXPECT_EQ(now.data()[k * entries + d], then.data()[from * entries + d]) << name;
    }
  };
  for_each_column(check, state, before);
}

/// A small plate on the water of a small tank.
struct Entry {
  Simulation<2> simulation;
  InterfaceMotion motion;
  static constexpr double speed = 6, dt = 1e-5;

  static Parameters parameters() {
    Parameters p = tank_case(0.4, 0.15, 0.01, 0.2);
    p.scheme.pressure_tolerance = 1e-12;
    return p;
  }
  static InterfaceMesh body() { return rectangle(-0.1, 0.0012, 0.2, 0.02, 0.01); }
  Entry() : simulation(parameters(), body(), PlateEntry::down(body(), speed)) {
    const auto m = simulation.interface().position.cols();
    motion = {Points::Zero(3, m), Points::Zero(3, m), Points::Zero(3, m)};
    motion.velocity.row(1).setConstant(-speed);
  }
  void steps(int count) {
    for (int k = 0; k < count; ++k) {
      motion.displacement.row(1).setConstant(-speed * (simulation.state().time + dt));
      simulation.step(dt, motion);
    }
  }
};

std::vector<std::size_t> place_of_id(const State<2>& state) {
  std::vector<std::size_t> place(state.id.size());
  for (std::size_t i = 0; i < state.id.size(); ++i) place[static_cast<std::size_t>(state.id[i])] = i;
  return place;
}

TEST(Reorder, a_step_moves_each_particle_the_same_way_in_any_order) {
  Entry one, other;
  one.steps(25);  // the plate has struck
  State<2> state = one.simulation.state();
  const auto water = std::count(state.kind.begin(), state.kind.end(), Kind::fluid);
  reorder(state, std::span<const std::int32_t>(shuffled(water)));
  other.simulation.set_state(state);
  one.steps(2);
  other.steps(2);
  const State<2>&a = one.simulation.state(), &b = other.simulation.state();
  ASSERT_NE(a.id, b.id);
  const double highest = a.pressure.cwiseAbs().maxCoeff();
  ASSERT_GT(highest, 1e6);
  const auto at = place_of_id(b);
  for (std::size_t i = 0; i < a.id.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(at[static_cast<std::size_t>(a.id[i])]);
    const auto j = static_cast<Eigen::Index>(i);
    // Sums in another order: round-off, and what the pressure solve leaves (1e-12).
    ASSERT_LT((a.position.col(j) - b.position.col(k)).norm(), 1e-12) << a.id[i];
    ASSERT_LT((a.velocity.col(j) - b.velocity.col(k)).norm(), 1e-7 * Entry::speed) << a.id[i];
    ASSERT_NEAR(a.pressure[j], b.pressure[k], 1e-7 * highest) << a.id[i];
    ASSERT_EQ(a.surface[i], b.surface[static_cast<std::size_t>(k)]) << a.id[i];
  }
}

TEST(Reorder, a_run_restarted_before_or_at_a_reordering_goes_on_with_the_same_bits) {
  Entry first;
  first.steps(static_cast<int>(reorder_interval) - 5);
  const State<2> before = first.simulation.state();
  first.steps(5);
  const State<2> at = first.simulation.state();
  EXPECT_EQ(before.id, at.id);
  first.steps(10);
  const State<2>& end = first.simulation.state();
  EXPECT_NE(before.id, end.id);  // it was sorted in between
  for (const State<2>* start : {&before, &at}) {
    Entry second;
    second.simulation.set_state(*start);
    second.steps(static_cast<int>(end.step - start->step));
    const State<2>& again = second.simulation.state();
    EXPECT_EQ(differences(again, end), "");
  }
}

}  // namespace reorder_test
}  // namespace strake::fluid
