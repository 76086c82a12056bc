#include "proto/files/frame_writer.hpp"

#include "proto/error.hpp"
#include "proto/files/hdf5_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace strake {
namespace frame_writer_test {

Frame some_frame(int k) {
  Frame frame;
  frame.time = 0.5 * k;
  frame.position = Points::Constant(3, 50, k);
  frame.point_data = {{"p", "Pa", Eigen::MatrixXd::Constant(1, 50, k)}};
  return frame;
}

TEST(FrameWriter, all_frames_are_on_disk_in_their_order_once_it_is_flushed) {
  const TemporaryFolder folder, at_once;
  constexpr int n = 12;  // several times what may wait
  FrameWriter writer(folder.path(), "fluid", 2);
  FrameSeries series(at_once.path(), "fluid", 2);
  for (int k = 0; k < n; ++k) {
    writer.write(some_frame(k));
    series.write(some_frame(k));
  }
  writer.flush();
  for (int k = 0; k < n; ++k) {
    const std::string file = fmt::format("frames/fluid-{:06}.h5", k);
    EXPECT_EQ(content(folder / file), content(at_once / file)) << file;
  }
  EXPECT_EQ(content(folder / "fluid.xdmf"), content(at_once / "fluid.xdmf"));
}

TEST(FrameWriter, what_waits_is_written_before_it_ends) {
  const TemporaryFolder folder;
  {
    FrameWriter writer(folder.path(), "fluid", 2);
    for (int k = 0; k < 3; ++k) writer.write(some_frame(k));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "frames/fluid-000002.h5"));
}

TEST(FrameWriter, a_frame_that_cannot_be_written_is_told_with_exit_code_6_and_none_follows) {
  const TemporaryFolder folder;
  FrameWriter writer(folder.path(), "fluid", 2);
  writer.write(some_frame(0));
  writer.flush();
  std::filesystem::create_directory(folder / "frames/fluid-000001.h5");  // a place that is taken
  writer.write(some_frame(1));
  const auto code_of = [](auto&& action) {
    try {
      action();
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::done;
  };
  EXPECT_EQ(code_of([&] { writer.flush(); }), ExitCode::cannot_write);
  EXPECT_EQ(code_of([&] { writer.check(); }), ExitCode::cannot_write);
  EXPECT_EQ(code_of([&] { writer.write(some_frame(2)); }), ExitCode::cannot_write);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000002.h5"));
}

TEST(FrameWriter, a_resumed_series_goes_on_after_its_checkpoint) {
  const TemporaryFolder folder;
  {
    FrameWriter writer(folder.path(), "fluid", 2);
    for (int k = 0; k < 4; ++k) writer.write(some_frame(k));
  }
  FrameWriter writer(folder.path(), "fluid", 2);
  writer.truncate(some_frame(1).time);
  EXPECT_FALSE(std::filesystem::exists(folder / "frames/fluid-000002.h5"));
  writer.write(some_frame(2));
  writer.flush();
  const hdf5::Reader file(folder / "frames/fluid-000002.h5", "strake frame 1");
  EXPECT_EQ(file.number("time"), some_frame(2).time);
}

}  // namespace frame_writer_test
}  // namespace strake
