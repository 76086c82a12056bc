#include "fluid/particles/state.hpp"

#include "fluid/particles/columns.hpp"
#include "tests/fluid/same_state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

namespace strake::fluid {
namespace state_test {

// That the sizes add up is asserted where State is defined: a member listed twice could hide one that is not.
TEST(State, EachMemberIsListedOnce) {
  State<2> state;
  std::set<std::string> names;
  std::set<const void*> places;
  std::size_t count = 0;
  const auto note = [&](const char* name, const auto& member) {
    names.insert(name);
    places.insert(&member);
    ++count;
  };
  for_each_column(note, state);
  for_each_value(note, state);
  EXPECT_EQ(names.size(), count);
  EXPECT_EQ(places.size(), count);
}

/// Bytes of column after column: 1, 2, 3 …
State<3> numbered(Eigen::Index n) {
  State<3> state;
  resize_particles(state, n);
  const auto number = [](const char*, auto& column) {
    for (Eigen::Index k = 0; k < std::ssize(column); ++k)
      column.data()[k] = static_cast<std::remove_reference_t<decltype(*column.data())>>(k % 250 + 1);
  };
  for_each_column(number, state);
  return state;
}

TEST(State, ParticlesThatAreAddedAreZeroAndThoseBeforeThemStay) {
  const State<3> before = numbered(7);
  State<3> state = before;
  resize_particles(state, 9);
  const auto check = [](const char* name, const auto& column) {
    ASSERT_EQ(length(column), 9) << name;
    const auto entries = std::ssize(column) / 9;
    for (auto k = 7 * entries; k < 9 * entries; ++k) EXPECT_EQ(static_cast<int>(column.data()[k]), 0) << name;
  };
  for_each_column(check, state);
  resize_particles(state, 7);
  EXPECT_EQ(differences(state, before), "");
}

TEST(State, ParticlesThatAreSelectedTakeAllTheirValuesAlong) {
  const State<3> before = numbered(7);
  State<3> state = before;
  const std::vector<std::int32_t> places{5, 0, 6};
  select_particles<3>(state, places);
  const auto check = [&](const char* name, const auto& now, const auto& then) {
    ASSERT_EQ(length(now), 3) << name;
    const auto entries = std::ssize(now) / 3;
    for (std::size_t k = 0; k < places.size(); ++k)
      for (auto d = 0 * entries; d < entries; ++d)
        EXPECT_EQ(now.data()[static_cast<std::ptrdiff_t>(k) * entries + d],
                  then.data()[places[k] * entries + d])
            << name;
  };
  for_each_column(check, state, before);
}

TEST(State, ADifferenceInOneMemberIsNamed) {
  const State<3> state = numbered(4);
  State<3> other = state;
  EXPECT_EQ(differences(state, other), "");
  other.velocity(2, 3) = std::nextafter(other.velocity(2, 3), 1e9);
  other.behind_walls = 1;
  EXPECT_EQ(differences(state, other), " velocity behind_walls");
}

}  // namespace state_test
}  // namespace strake::fluid
