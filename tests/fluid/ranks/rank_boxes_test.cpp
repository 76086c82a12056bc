#include "fluid/ranks/rank_boxes.hpp"

#include "fluid/ranks/buckets.hpp"
#include "proto/ranks/communicator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace strake::fluid {
namespace rank_boxes_test {

using Box = std::array<double, 6>;
constexpr double far = std::numeric_limits<double>::max();

/// Boxes that fill all space, cut again and again at numbers from 0 to 100, across each axis in turn.
std::vector<double> cut_space(int count, int axes, std::mt19937& random) {
  std::vector<Box> boxes{{-far, -far, -far, far, far, far}};
  for (int k = 0; static_cast<int>(boxes.size()) < count; ++k) {
    Box& lower = boxes[static_cast<std::size_t>(k)];
    const auto axis = static_cast<std::size_t>(k % axes);
    const double low = std::max(lower[axis], 0.0), high = std::min(lower[3 + axis], 100.0);
    Box upper = lower;
    lower[3 + axis] = upper[axis] = std::uniform_real_distribution(low + 0.3 * (high - low), high)(random);
    boxes.push_back(upper);
  }
  std::ranges::shuffle(boxes, random);
  std::vector<double> values;
  for (const Box& box : boxes) values.insert(values.end(), box.begin(), box.end());
  return values;
}

/// The first of all boxes, one after the other, that has the place.
int owner_among_all(const std::vector<double>& boxes, const RankBoxes::Place& at) {
  for (std::size_t rank = 0; 6 * rank < boxes.size(); ++rank) {
    bool inside = true;
    for (std::size_t d = 0; d < 3; ++d)
      inside = inside && boxes[6 * rank + d] < at[d] && at[d] <= boxes[6 * rank + 3 + d];
    if (inside) return static_cast<int>(rank);
  }
  return 0;
}

std::vector<RankBoxes::Place> places(const std::vector<double>& boxes, int count, std::mt19937& random) {
  std::uniform_real_distribution<double> anywhere(-10, 110);
  std::uniform_int_distribution<std::size_t> any_bound(0, boxes.size() - 1);
  std::vector<RankBoxes::Place> list;
  for (int k = 0; k < count; ++k) {
    RankBoxes::Place at;
    for (double& x : at) x = k % 2 == 0 ? anywhere(random) : boxes[any_bound(random)];  // on a bound
    list.push_back(at);
  }
  list.push_back({std::numeric_limits<double>::quiet_NaN(), 1, 1});
  return list;
}

TEST(RankBoxes, TheOwnerIsThatOfALookAtAllBoxes) {
  std::mt19937 random(7);
  for (const int axes : {2, 3})
    for (const int count : {1, 2, 5, 64, 2048}) {
      const std::vector<double> values = cut_space(count, axes, random);
      RankBoxes boxes;
      boxes.assign(values);
      for (const RankBoxes::Place& at : places(values, 2000, random))
        ASSERT_EQ(boxes.owner(at), owner_among_all(values, at)) << count << " boxes";
    }
}

TEST(RankBoxes, OfBoxesThatOverlapTheLowestRankOwns) {
  std::mt19937 random(8);
  std::vector<double> values;
  std::uniform_real_distribution<double> anywhere(0, 100);
  for (int k = 0; k < 300; ++k) {
    Box box;
    for (std::size_t d = 0; d < 3; ++d) {
      box[d] = anywhere(random);
      box[3 + d] = box[d] + 0.3 * anywhere(random);
    }
    values.insert(values.end(), box.begin(), box.end());
  }
  RankBoxes boxes;
  boxes.assign(values);
  for (const RankBoxes::Place& at : places(values, 2000, random))
    ASSERT_EQ(boxes.owner(at), owner_among_all(values, at));
}

TEST(RankBoxes, ALookAtThousandsOfBoxesIsCheap) {
  std::mt19937 random(9);
  const std::vector<double> values = cut_space(2048, 3, random);
  RankBoxes boxes;
  boxes.assign(values);
  const auto list = places(values, 20000, random);
  std::int64_t sum = 0;
  const auto time_of = [&](auto&& owner) {
    const double start = processor_time(CLOCK_THREAD_CPUTIME_ID);
    for (const RankBoxes::Place& at : list) sum += owner(at);
    return processor_time(CLOCK_THREAD_CPUTIME_ID) - start;
  };
  const double all = time_of([&](const auto&at) { return owner_among_all(values, at); }),
               own = time_of([&](const auto&at) { return boxes.owner(at); });
  EXPECT_LT(own, 0.1 * all) << sum;
}

// A bucket at the corner of eight boxes is wanted by the ranks of the seven others.
TEST(RankBoxes, ABucketIsWantedByTheRanksAround) {
  std::vector<double> values;
  for (int k = 0; k < 8; ++k) {
    Box box;
    for (std::size_t d = 0; d < 3; ++d) {
      const bool upper = (k >> d & 1) != 0;
      box[d] = upper ? 9.5 : -far;
      box[3 + d] = upper ? far : 9.5;
    }
    values.insert(values.end(), box.begin(), box.end());
  }
  RankBoxes boxes;
  boxes.assign(values);
  const Buckets<3> buckets(1, Periodic<3>(), Vector<3>::Zero());
  std::vector<Wanting> wanting;
  buckets.find_wanting({9, 9, 9}, boxes, 0, wanting);
  EXPECT_EQ(wanting.size(), 7u);
  for (const Wanting& other : wanting) EXPECT_TRUE(other.near) << other.rank;
  wanting.clear();
  buckets.find_wanting({8, 5, 5}, boxes, 0, wanting);
  ASSERT_EQ(wanting.size(), 1u);
  EXPECT_EQ(wanting.front().rank, 1);
  EXPECT_FALSE(wanting.front().near);
  wanting.clear();
  buckets.find_wanting({5, 5, 5}, boxes, 0, wanting);
  EXPECT_TRUE(wanting.empty());
}

// What a stretch along x is said to be, all its places are, also where the tank repeats itself along x.
TEST(RankBoxes, TheAnswerForAStretchIsThatOfItsPlaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-2, 102), length(0, 30);
  for (const double period : {0.0, 2.3, 100.0}) {
    RankBoxes boxes;
    boxes.assign(cut_space(12, 3, random));
    const Buckets<3> buckets(1, Periodic<3>(Vector<3>(period, 0, 0)), Vector<3>::Zero());
    int known = 0, own = 0;
    for (int k = 0; k < 4000; ++k) {
      const int rank = k % 12;
      const Vector<3> first(anywhere(random), anywhere(random), anywhere(random));
      const Vector<3> last = first + Vector<3>(k % 3 == 0 ? 0 : length(random), 0, 0);
      const std::optional<bool> all = buckets.owns_all(rank, first, last, boxes);
      EXPECT_TRUE(all.has_value() || k % 3 != 0) << "of one place there is an answer";
      if (!all) continue;
      ++known;
      own += *all ? 1 : 0;
      for (double x = first[0]; x <= last[0]; x += 0.1) {
        const Bucket bucket = buckets.of({x, first[1], first[2]});
        EXPECT_EQ(Buckets<3>::owner(bucket, boxes, rank) == rank, *all) << k << " at " << x;
      }
    }
    EXPECT_GT(known, 1000);
    EXPECT_GT(own, 20);
  }
}

}  // namespace rank_boxes_test
}  // namespace strake::fluid
