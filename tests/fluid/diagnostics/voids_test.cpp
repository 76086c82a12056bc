#include "fluid/diagnostics/voids.hpp"

#include "fluid/boundary/fill.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace strake::fluid {
namespace {

constexpr double l0 = 0.02;

/// 1.2 × 0.6 m of water in a tank 2 × 1 m, open, without a flag.
State<2> column() {
  Parameters p;
  p.spacing = l0;
  p.tank.min = {0, 0, 0};
  p.tank.max = {2.0, 1.0, 0};
  p.water.min = {0, 0, 0};
  p.water.max = {1.2, 0.6, 0};
  State<2> state = fill<2>(p);
  std::fill(state.surface.begin(), state.surface.end(), std::uint8_t{0});
  return state;
}

std::vector<std::int64_t> water(const State<2>& state) {
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < state.kind.size(); ++i)
    if (state.kind[i] == Kind::fluid) numbers.push_back(static_cast<std::int64_t>(i));
  return numbers;
}

template <class Where>
void flag(State<2>& state, Where&& where) {
  for (const std::int64_t i : water(state))
    if (where(Vector<2>(state.position.col(i)))) state.surface[static_cast<std::size_t>(i)] = 1;
}

TEST(Voids, the_outer_surface_of_a_column_is_none_however_low_it_has_sunk) {
  State<2> state = column();
  flag(state, [](const Vector<2>& x) { return x[0] > 1.2 - l0 || x[1] > 0.6 - l0; });
  EXPECT_EQ(count_voids<2>(state, water(state), l0, true).all, 0);
  EXPECT_EQ(count_voids<2>(state, water(state), l0, false).all,
            0);  // the air of the tank is the largest space
}

TEST(Voids, flags_more_than_five_spacings_and_a_cell_below_the_surface_are_counted) {
  for (const int depth : {3, 5, 8, 15}) {
    State<2> state = column();
    const double y = 0.6 - (depth + 0.5) * l0;
    flag(state, [&](const Vector<2>& x) {
      return std::abs(x[1] - y) < 0.1 * l0 && std::abs(x[0] - 0.5) < 2.1 * l0;
    });
    if (depth == 5) continue;  // within the width of a cell
    EXPECT_EQ(count_voids<2>(state, water(state), l0, true).all, depth > 6 ? 4 : 0) << depth;
  }
}

TEST(Voids, the_skin_of_a_hole_in_the_water_is_counted_but_not_that_of_a_bay) {
  for (const bool open : {false, true}) {
    State<2> state = column();
    const Vector<2> middle(0.6, 0.3);
    std::vector<std::int64_t> left;
    for (const std::int64_t i : water(state)) {
      const Vector<2> x = state.position.col(i);
      const bool in_hole = (x - middle).norm() < 4 * l0;
      const bool in_channel = open && std::abs(x[0] - middle[0]) < 4 * l0 && x[1] > middle[1];
      if (!in_hole && !in_channel) left.push_back(i);
    }
    flag(state, [&](const Vector<2>& x) { return (x - middle).norm() < 5.2 * l0; });
    const auto voids = count_voids<2>(state, left, l0, true).all;
    if (open)
      EXPECT_EQ(voids, 0);
    else
      EXPECT_GT(voids, 10);
  }
}

/// The state after so many evaluations with those flags.
void follow(State<2>& state, int times) {
  NeighbourSearch<2> search(2.1 * l0, 0.1 * l0);
  const auto count = static_cast<std::int64_t>(water(state).size());
  std::vector<std::uint8_t> scratch;
  for (int k = 0; k < times; ++k) follow_air<2>(state, search.update(state.position), count, scratch);
}

TEST(Voids, air_that_water_shuts_in_stays_air_and_a_hole_that_opens_inside_is_none) {
  State<2> state = column();
  const auto at_top = [](const Vector<2>& x) { return x[1] > 0.6 - l0; };
  const auto in_bay = [](const Vector<2>& x) { return std::abs(x[0] - 0.3) < 2 * l0 && x[1] > 0.3; };
  const auto in_pocket = [&](const Vector<2>& x) { return in_bay(x) && x[1] < 0.4; };
  const auto in_hole = [](const Vector<2>& x) { return (x - Vector<2>(0.9, 0.3)).norm() < 2 * l0; };
  flag(state, at_top);
  flag(state, in_bay);  // from the air down, and then closed at its mouth
  follow(state, 30);
  std::fill(state.surface.begin(), state.surface.end(), std::uint8_t{0});
  flag(state, at_top);
  flag(state, in_pocket);
  flag(state, in_hole);
  follow(state, 3);
  std::int64_t pocket = 0, hole = 0;
  for (const std::int64_t i : water(state)) {
    const Vector<2> x = state.position.col(i);
    pocket += in_pocket(x) ? 1 : 0;
    hole += in_hole(x) ? 1 : 0;
    EXPECT_EQ(state.air_connected[static_cast<std::size_t>(i)] != 0, at_top(x) || in_pocket(x))
        << x.transpose();
  }
  ASSERT_GT(pocket, 0);
  ASSERT_GT(hole, 0);
  const Voids voids = count_voids<2>(state, water(state), l0, true);
  EXPECT_EQ(voids.internal_voids, hole);
  EXPECT_EQ(voids.all, hole + pocket);
}

}  // namespace
}  // namespace strake::fluid
