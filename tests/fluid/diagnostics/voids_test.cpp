#include "fluid/diagnostics/voids.hpp"

#include "fluid/boundary/fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace strake::fluid {
namespace voids_test {

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
  EXPECT_EQ(count_voids<2>(state, water(state), l0, true).value().all, 0);
  EXPECT_EQ(count_voids<2>(state, water(state), l0, false).value().all,
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
    EXPECT_EQ(count_voids<2>(state, water(state), l0, true).value().all, depth > 6 ? 4 : 0) << depth;
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
    const auto voids = count_voids<2>(state, left, l0, true).value().all;
    if (open)
      EXPECT_EQ(voids, 0);
    else
      EXPECT_GT(voids, 10);
  }
}

/// Counts voids cell by cell, over the whole box around the particles, as the definition says it.
template <int dim>
Voids count_in_whole_box(const State<dim>& state, std::span<const std::int64_t> water, bool open_top) {
  using Place = std::array<std::int64_t, 3>;
  Vector<dim> low = state.position.rowwise().minCoeff(), high = state.position.rowwise().maxCoeff();
  Place size{1, 1, 1};
  const auto axis = [](std::size_t d) { return static_cast<Eigen::Index>(d); };
  for (std::size_t d = 0; d < dim; ++d)
    size[d] = static_cast<std::int64_t>((high[axis(d)] - low[axis(d)]) / l0) + (d == 1 ? 4 : 1);
  std::vector<int> all(static_cast<std::size_t>(size[0] * size[1] * size[2]));
  // Number of the space of a cell; 0: none yet; −1: at a particle.
  const auto space = [&](const Place& p) -> int& {
    return all[static_cast<std::size_t>((p[2] * size[1] + p[1]) * size[0] + p[0])];
  };
  const auto around = [&](Eigen::Index i, std::int64_t width, const auto& visit) {
    Place at{}, from{}, to{};
    for (std::size_t d = 0; d < dim; ++d) {
      at[d] = static_cast<std::int64_t>((state.position(axis(d), i) - low[axis(d)]) / l0);
      from[d] = std::max<std::int64_t>(at[d] - width, 0);
      to[d] = std::min(at[d] + width, size[d] - 1);
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t x = from[0]; x <= to[0]; ++x) visit(Place{x, y, z});
  };
  for (Eigen::Index i = 0; i < state.position.cols(); ++i)
    around(i, 1, [&](const Place& p) { space(p) = -1; });
  std::vector<std::int64_t> cells{0};
  std::vector<bool> outer{false};
  const auto fill = [&](const Place& start) {
    if (space(start) != 0) return;
    const auto number = static_cast<int>(cells.size());
    cells.push_back(0);
    outer.push_back(false);
    space(start) = number;
    std::vector<Place> open{start};
    while (!open.empty()) {
      const Place p = open.back();
      open.pop_back();
      ++cells.back();
      if (open_top && p[1] == size[1] - 1) outer.back() = true;
      for (std::size_t d = 0; d < dim; ++d)
        for (const std::int64_t step : {-1, 1}) {
          Place q = p;
          q[d] += step;
          if (q[d] < 0 || q[d] >= size[d] || space(q) != 0) continue;
          space(q) = number;
          open.push_back(q);
        }
    }
  };
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x) fill({x, y, z});
  if (!open_top)
    outer[static_cast<std::size_t>(std::max_element(cells.begin(), cells.end()) - cells.begin())] =
        cells.size() > 1;
  Voids voids;
  for (const std::int64_t i : water) {
    bool near = false;
    around(i, 7, [&](const Place& p) {
      near = near || (space(p) > 0 && outer[static_cast<std::size_t>(space(p))]);
    });
    if (state.surface[static_cast<std::size_t>(i)] == 0 || near) continue;
    ++voids.all;
    voids.internal_voids += state.air_connected[static_cast<std::size_t>(i)] == 0 ? 1 : 0;
  }
  return voids;
}

/// Water all over a box with round holes of random size and place, some of them open to the top.
template <int dim>
State<dim> porous(const Vector<dim>& box, int holes, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> share(0, 1);
  std::vector<std::pair<Vector<dim>, double>> hole;
  for (int k = 0; k < holes; ++k) {
    Vector<dim> middle;
    for (int d = 0; d < dim; ++d) middle[d] = share(generator) * box[d];
    hole.emplace_back(middle, (2 + 14 * share(generator)) * l0);
  }
  std::vector<Vector<dim>> place;
  Vector<dim> x = Vector<dim>::Constant(0.5 * l0);
  while (x[dim - 1] < box[dim - 1]) {
    bool in = false;
    for (const auto& [middle, radius] : hole) in = in || (x - middle).norm() < radius;
    if (!in) place.push_back(x);
    for (int d = 0; d < dim; ++d) {
      x[d] += l0;
      if (x[d] < box[d] || d == dim - 1) break;
      x[d] = 0.5 * l0;
    }
  }
  State<dim> state;
  state.position.resize(dim, static_cast<Eigen::Index>(place.size()));
  for (std::size_t k = 0; k < place.size(); ++k) state.position.col(static_cast<Eigen::Index>(k)) = place[k];
  state.kind.assign(place.size(), Kind::fluid);
  state.surface.assign(place.size(), 1);
  for (std::size_t k = 0; k < place.size(); ++k) state.air_connected.push_back(k % 3 == 0);
  return state;
}

template <int dim>
void expect_as_in_whole_box(const State<dim>& state) {
  std::vector<std::int64_t> all(state.kind.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int64_t>(i);
  for (const bool open_top : {true, false}) {
    const Voids voids = count_voids<dim>(state, all, l0, open_top).value();
    const Voids expected = count_in_whole_box<dim>(state, all, open_top);
    EXPECT_GT(expected.all, 0);
    EXPECT_EQ(voids.all, expected.all);
    EXPECT_EQ(voids.internal_voids, expected.internal_voids);
  }
}

TEST(Voids, blocks_of_cells_give_the_same_as_all_cells_of_the_box) {
  for (unsigned seed = 1; seed < 5; ++seed) {
    expect_as_in_whole_box<2>(porous<2>({3.1, 2.3}, 25, seed));
    expect_as_in_whole_box<3>(porous<3>({0.85, 0.75, 0.65}, 9, seed));
  }
  State<2> far = porous<2>({1.5, 1.1}, 12, 3);
  far.position.col(5) << 4.7, 3.9;  // many blocks of air alone
  expect_as_in_whole_box<2>(far);
}

TEST(Voids, a_hole_is_found_in_a_box_of_more_cells_than_bytes_and_none_is_made_up_beyond) {
  State<3> state = porous<3>({0.6, 0.6, 0.6}, 0, 1);
  std::vector<std::int64_t> left;
  const Vector<3> middle(0.3, 0.3, 0.3);
  for (Eigen::Index i = 0; i < state.position.cols(); ++i) {
    const double from_middle = (state.position.col(i) - middle).norm();
    if (from_middle > 3 * l0) left.push_back(i);
    state.surface[static_cast<std::size_t>(i)] = from_middle < 4 * l0 ? 1 : 0;
  }
  const auto near = count_voids<3>(state, left, l0, true);
  ASSERT_TRUE(near);
  EXPECT_GT(near->all, 20);
  state.position.col(left.back()) << 1.3e3 * l0, 1.3e3 * l0, 1.3e3 * l0;  // 2.2e9 cells
  const auto with_drop = count_voids<3>(state, left, l0, true);
  ASSERT_TRUE(with_drop);
  EXPECT_EQ(with_drop->all, near->all);
  state.position.col(left.back()) << 1e9 * l0, 1e9 * l0, 1e9 * l0;
  EXPECT_FALSE(count_voids<3>(state, left, l0, true));
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
  const Voids voids = count_voids<2>(state, water(state), l0, true).value();
  EXPECT_EQ(voids.internal_voids, hole);
  EXPECT_EQ(voids.all, hole + pocket);
}

}  // namespace voids_test
}  // namespace strake::fluid
