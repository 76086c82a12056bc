#include "proto/ranks/ranked_frames.hpp"

#include "proto/error.hpp"
#include "proto/files/frame_file.hpp"
#include "proto/files/hdf5_file.hpp"
#include "proto/ranks/agreement.hpp"
#include "tests/fluid/ranks/thread_communicator.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

namespace strake {
namespace ranked_frames_test {

using fluid::ThreadRanks;

constexpr int points_of[] = {3, 0, 2};  // of each rank

/// The points of all ranks; those of one alone with `rank`.
Frame cloud(double time, int rank = -1) {
  const int before = rank < 1 ? 0 : points_of[0], n = rank < 0 ? 5 : points_of[rank];
  Frame frame;
  frame.time = time;
  frame.position.resize(3, n);
  Eigen::MatrixXd pressure(1, n);
  for (int k = 0; k < n; ++k) {
    frame.position.col(k) = Eigen::Vector3d(before + k, time, -1);
    pressure(0, k) = 10 * (before + k) + time;
  }
  frame.point_data = {{"pressure", "Pa", pressure}, {"velocity", "m/s", Eigen::MatrixXd(2 * frame.position)}};
  return frame;
}

void write(const TemporaryFolder& folder, const std::vector<double>& times, double from = -1) {
  ThreadRanks(3).run([&](Communicator& ranks) {
    RankedFrames frames(folder.path(), "fluid", 2, ranks);
    if (from >= 0) frames.truncate(from);
    for (const double time : times) frames.write(cloud(time, ranks.rank()));
    frames.flush();
  });
}

std::string error_of(const std::function<void()>& call, ExitCode code) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    return to_text(error);
  }
  return "no error";
}

TEST(RankedFrames, the_parts_of_all_ranks_read_as_one_frame) {
  const TemporaryFolder folder, one;
  write(folder, {0.0, 0.5});
  FrameSeries series(one.path(), "fluid", 2);
  for (const double time : {0.0, 0.5}) series.write(cloud(time));
  EXPECT_EQ(content(folder / "fluid.xdmf"), content(one / "fluid.xdmf"));
  const auto frames = list_frames(folder.path(), "fluid");
  ASSERT_EQ(frames.size(), 2U);
  const Frame frame = read_frame(frames[1].path),
              whole = read_frame(list_frames(one.path(), "fluid")[1].path);
  EXPECT_EQ(frame.time, 0.5);
  EXPECT_EQ(frame.position, whole.position);
  ASSERT_EQ(frame.point_data.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(frame.point_data[i].name, whole.point_data[i].name);
    EXPECT_EQ(frame.point_data[i].unit, whole.point_data[i].unit);
    EXPECT_EQ(frame.point_data[i].value, whole.point_data[i].value);
  }
  const hdf5::Reader file(frames[1].path, hdf5::frame_format);
  EXPECT_EQ(file.integer("/cells"), (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  const hdf5::Slice slice{5, {{1, 2}, {2, 4}}};
  EXPECT_EQ(file.integer("/cells", &slice), (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_EQ(file.real("/point/pressure", &slice), whole.point_data[0].value.middleCols(1, 3).transpose());
}

TEST(RankedFrames, equal_frames_are_equal_bytes) {
  const TemporaryFolder folder, again;
  for (const TemporaryFolder* place : {&folder, &again}) write(*place, {0.0});
  for (const char* file : {"frames/fluid-000000.h5", "frames/fluid-000000/0002.h5"})
    EXPECT_EQ(content(folder / file), content(again / file)) << file;
}

TEST(RankedFrames, a_part_that_is_missing_or_damaged_is_an_error_that_names_it) {
  const TemporaryFolder folder;
  write(folder, {0.0});
  const auto frame = folder / "frames/fluid-000000.h5", part = folder / "frames/fluid-000000/0002.h5";
  const auto text = [&] { return error_of([&] { read_frame(frame); }, ExitCode::case_file); };
  const std::string bytes = content(part);
  put(part, bytes.substr(0, bytes.size() - 8));
  EXPECT_NE(text().find("0002.h5 has " + std::to_string(bytes.size() - 8) + " bytes, not"), std::string::npos)
      << text();
  put(part, std::string(bytes.size(), 'x'));
  EXPECT_NE(text().find("0002.h5 is damaged"), std::string::npos) << text();
  std::filesystem::remove(part);
  EXPECT_NE(text().find("0002.h5 is missing"), std::string::npos) << text();
  EXPECT_EQ(list_frames(folder.path(), "fluid").size(), 1U);  // it is not left out in silence
  std::filesystem::remove(folder / "frames/fluid-000000/0001.h5");
  put(part, bytes);
  EXPECT_EQ(read_frame(frame).position.cols(), 5);  // the second rank had no points
}

TEST(RankedFrames, a_rank_that_cannot_write_is_an_error_on_all_and_leaves_no_frame) {
  const TemporaryFolder folder;
  std::atomic<int> told = 0;
  ThreadRanks(3).run([&](Communicator& ranks) {
    RankedFrames frames(folder.path(), "fluid", 2, ranks);
    frames.write(cloud(0, ranks.rank()));
    frames.flush();
    if (ranks.rank() == 0) std::filesystem::create_directories(folder / "frames/fluid-000001/0002.h5/taken");
    ranks.any(false);
    const std::string text = error_of(
        [&] {
          frames.write(cloud(0.5, ranks.rank()));
          frames.flush();
        },
        ExitCode::cannot_write);
    EXPECT_NE(text.find("fluid-000001/0002.h5: cannot be written"), std::string::npos) << text;
    ++told;
  });
  EXPECT_EQ(told, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000001"));
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000001.h5"));
  EXPECT_EQ(list_frames(folder.path(), "fluid").size(), 1U);
}

// The ranks compute on while their parts are written.
TEST(RankedFrames, a_frame_is_joined_by_the_first_look_that_finds_all_parts) {
  const TemporaryFolder folder;
  ThreadRanks(3).run([&](Communicator& ranks) {
    RankedFrames frames(folder.path(), "fluid", 2, ranks);
    frames.look();  // nothing is under way
    frames.write(cloud(0, ranks.rank()));
    EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000000.h5"));
    ranks.any(false);  // all have looked
    const auto joined = [&] { return ranks.any(std::filesystem::exists(folder / "frames/fluid-000000.h5")); };
    for (int k = 0; k < 1000 && !joined(); ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      frames.look();
    }
    EXPECT_TRUE(joined());
    ranks.any(false);
    frames.write(cloud(0.5, ranks.rank()));
    frames.write(cloud(0.7, ranks.rank()));  // joins the one before
    EXPECT_TRUE(joined());
  });
  EXPECT_EQ(list_frames(folder.path(), "fluid").size(), 2U) << "the last one was not joined";
  EXPECT_EQ(read_frame(folder / "frames/fluid-000001.h5").time, 0.5);
}

TEST(RankedFrames, a_part_that_fails_meanwhile_is_told_by_a_look) {
  const TemporaryFolder folder;
  std::atomic<int> told = 0;
  ThreadRanks(3).run([&](Communicator& ranks) {
    RankedFrames frames(folder.path(), "fluid", 2, ranks);
    if (ranks.rank() == 0) std::filesystem::create_directories(folder / "frames/fluid-000000/0001.h5/taken");
    ranks.any(false);
    frames.write(cloud(0, ranks.rank()));
    const std::string text = error_of(
        [&] {
          for (int k = 0; k < 1000; ++k) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            frames.look();
          }
        },
        ExitCode::cannot_write);
    EXPECT_NE(text.find("fluid-000000/0001.h5: cannot be written"), std::string::npos) << text;
    ++told;
  });
  EXPECT_EQ(told, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000000"));
}

TEST(RankedFrames, a_resumed_series_drops_later_frames_with_their_parts) {
  const TemporaryFolder folder, straight;
  write(straight, {0.0, 0.1, 0.2});
  write(folder, {0.0, 0.1, 0.15, 0.17});
  std::filesystem::create_directory(folder / "frames/fluid-000004");  // killed before its frame was there
  write(folder, {0.2}, 0.12);
  EXPECT_EQ(content(folder / "fluid.xdmf"), content(straight / "fluid.xdmf"));
  EXPECT_EQ(read_frame(folder / "frames/fluid-000002.h5").time, 0.2);
  for (const char* gone : {"frames/fluid-000003.h5", "frames/fluid-000003", "frames/fluid-000004"})
    EXPECT_FALSE(std::filesystem::exists(folder / gone)) << gone;
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/fluid-000001/0000.h5"));
}

TEST(OnAllRanks, what_one_rank_throws_all_ranks_throw) {
  std::atomic<int> told = 0;
  ThreadRanks(3).run([&](Communicator& ranks) {
    on_all_ranks(ranks, [] {});
    const std::string text = error_of(
        [&] {
          on_all_ranks(ranks, [&] {
            if (ranks.rank() == 1) throw Error(ExitCode::cannot_write, "here", "broke\nmore", "mend it");
            if (ranks.rank() == 2) throw std::runtime_error("odd");
          });
        },
        ExitCode::cannot_write);
    EXPECT_EQ(text, to_text(Error(ExitCode::cannot_write, "here", "broke\nmore", "mend it")));
    EXPECT_NE(
        error_of([&] { on_first_rank(ranks, [] { throw std::runtime_error("odd"); }); }, ExitCode::our_bug)
            .find("rank 0: unexpected: odd"),
        std::string::npos);
    ++told;
  });
  EXPECT_EQ(told, 3);
}

}  // namespace ranked_frames_test
}  // namespace strake
