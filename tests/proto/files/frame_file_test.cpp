#include "proto/files/frame_file.hpp"

#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "proto/interface.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

namespace strake {
namespace frame_file_test {

Frame triangle(double time) {
  Frame frame;
  frame.time = time;
  frame.position.resize(3, 3);
  frame.position << 0, 1, 0,  //
      0, 0, 2,                //
      0, 0, 0;
  frame.cells.resize(3, 1);
  frame.cells << 0, 1, 2;
  frame.point_data = {{"velocity", "m/s", frame.position},
                      {"von_mises", "Pa", Eigen::MatrixXd::Constant(1, 3, 7)}};
  return frame;
}

TEST(FrameFile, AFrameReadsBackAsItWasWritten) {
  const TemporaryFolder folder;
  FrameSeries series(folder.path(), "structure", 2);
  for (const double time : {0.0, 0.1, 0.2}) series.write(triangle(time));
  const auto frames = list_frames(folder.path(), "structure");
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(nearest(frames, 0.14)->time, 0.1);
  EXPECT_EQ(nearest(frames, std::numeric_limits<double>::infinity())->time, 0.2);
  const Frame frame = read_frame(frames[1].path);
  EXPECT_EQ(frame.time, 0.1);
  EXPECT_EQ(frame.position, triangle(0).position);
  EXPECT_EQ(frame.cells, triangle(0).cells);
  ASSERT_EQ(frame.point_data.size(), 2U);
  EXPECT_EQ(frame.point_data[1].name, "von_mises");
  EXPECT_EQ(frame.point_data[1].unit, "Pa");
  EXPECT_EQ(frame.point_data[1].value, triangle(0).point_data[1].value);
}

TEST(FrameFile, ParticlesHaveNoCellsAndDamagedFramesAreLeftOut) {
  const TemporaryFolder folder;
  FrameSeries series(folder.path(), "fluid", 2);
  Frame frame = triangle(0);
  frame.cells.resize(0, 0);
  series.write(frame);
  std::ofstream(folder / "frames/fluid-000001.h5") << "no";
  const auto frames = list_frames(folder.path(), "fluid");
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(read_frame(frames[0].path).cells.cols(), 0);
  EXPECT_TRUE(list_frames(folder.path(), "structure").empty());
  EXPECT_EQ(nearest({}, 1), nullptr);
  EXPECT_THROW(read_frame(folder / "frames/fluid-000001.h5"), Error);
}

// A value of each particle is looked up by its first component.
TEST(FrameFile, AnArrayWithoutComponentsIsRefused) {
  const TemporaryFolder folder;
  Frame frame = triangle(0);
  frame.point_data.push_back({"kind", "1", Eigen::MatrixXd(0, 3)});
  FrameSeries(folder.path(), "fluid", 2).write(frame);
  expect_refused([&] { read_frame(folder / "frames/fluid-000000.h5"); }, "/point/kind has no columns");
}

TEST(FrameFile, SeveralBodiesAreOneFrameAndLackedValuesAreNaN) {
  Frame rigid = triangle(0);
  rigid.point_data.pop_back();  // it has no stress
  for (const bool rigid_first : {false, true}) {
    const Frame all = rigid_first ? joined({rigid, triangle(0)}) : joined({triangle(0), rigid});
    EXPECT_EQ(all.position.cols(), 6);
    EXPECT_EQ(all.cells.cols(), 2);
    const Frame::Array* stress = find(all.point_data, "von_mises");
    ASSERT_NE(stress, nullptr);
    EXPECT_EQ(stress->value(0, rigid_first ? 3 : 0), 7);
    EXPECT_TRUE(std::isnan(stress->value(0, rigid_first ? 0 : 3)));
    const Frame::Array* velocity = find(all.point_data, "velocity");
    ASSERT_NE(velocity, nullptr);
    EXPECT_TRUE(velocity->value.allFinite());
  }
}

}  // namespace frame_file_test
}  // namespace strake
