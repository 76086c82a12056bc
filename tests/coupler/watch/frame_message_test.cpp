// The arrays and frames that the page of a run gets.
#include "coupler/participant/interface_record.hpp"
#include "coupler/watch/web/field_view.hpp"
#include "coupler/watch/web/frame_cache.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"
#include "tests/coupler/watch/page_fixture.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace strake::watch {
namespace frame_message_test {

/// A square of one cell, moved down by a tenth of a metre, one corner bent by a hundredth.
Frame plate(double time) {
  Frame frame;
  frame.time = time;
  frame.position = Points::Zero(3, 4);
  frame.position.row(0) << 0, 1, 1, 0;
  frame.position.row(1) << 0, 0, 1, 1.01;
  frame.cells = Eigen::MatrixXi(4, 1);
  frame.cells << 0, 1, 2, 3;
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(3, 4);
  u.row(1) << -0.1, -0.1, -0.1, -0.09;
  frame.point_data = {{"displacement", "m", u}, {"von_mises", "Pa", Eigen::MatrixXd::Constant(1, 4, 5e6)}};
  return frame;
}

TEST(ArrayMessage, HoldsEveryArrayWhereItsHeadSays) {
  for (const std::size_t n : {0, 1, 5, 1000}) {
    ArrayMessage message;
    message.head["note"] = std::string(n, 'x');
    message.add("a", std::vector<float>(n, 1.5F));
    message.add("b", std::vector<std::uint8_t>(3, 7));
    message.add("c", std::vector<double>{1e300});
    const Read read(message.bytes());
    EXPECT_EQ(read.head["note"].get<std::string>().size(), n);
    EXPECT_EQ(read.array<float>("a"), std::vector<float>(n, 1.5F));
    EXPECT_EQ(read.array<std::uint8_t>("b"), (std::vector<std::uint8_t>{7, 7, 7}));
    EXPECT_EQ(read.array<double>("c"), std::vector<double>{1e300});
  }
}

TEST(FieldMessage, ShowsWaterAndWallsAndTakesTheRangeFromTheWater) {
  const Read read(
      field_message(water(0.5), {.side = "fluid", .field = "pressure", .dimension = 2, .keys = {}}).bytes());
  EXPECT_EQ(read.array<float>("position"), (std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}));
  EXPECT_EQ(read.array<float>("value"), (std::vector<float>{100, 200, 5000}));
  EXPECT_EQ(read.array<std::uint8_t>("kind"), (std::vector<std::uint8_t>{0, 0, 1}));
  EXPECT_EQ(read.array<std::uint32_t>("index"), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(read.head["time"], 0.5);
  EXPECT_EQ(read.head["field"]["all"], (Json{100, 200}));
  EXPECT_EQ(read.head["field"]["unit"], "Pa");
  EXPECT_EQ(read.head["high"], (Json{2, 0, 0}));
  const Read speed(
      field_message(water(0), {.side = "fluid", .field = "speed", .dimension = 2, .keys = {}}).bytes());
  EXPECT_EQ(speed.array<float>("value"), (std::vector<float>{5, 0, 0}));
  const Read none(
      field_message(water(0), {.side = "fluid", .field = "damage", .dimension = 2, .keys = {}}).bytes());
  EXPECT_TRUE(none.array<float>("value").empty());
  EXPECT_EQ(none.head["fields"][1]["name"], "speed");
}

TEST(FieldMessage, TellsABendFromTheMotionOfTheSupports) {
  const Read read(field_message(plate(0.05), {.side = "structure",
                                              .field = "von_mises",
                                              .dimension = 2,
                                              .keys = {{"structure.velocity", "[0, -2, 0]"}}})
                      .bytes());
  const auto bend = read.array<float>("bend");
  ASSERT_EQ(bend.size(), 12U);
  EXPECT_NEAR(bend[1], 0, 1e-7);
  EXPECT_NEAR(bend[10], 0.01, 1e-7);
  EXPECT_EQ(read.array<std::uint32_t>("triangle"), (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(read.array<std::uint32_t>("edge").size(), 8U);
}

TEST(FieldMessage, NamesTheBodiesWhereThereAreSeveral) {
  const FieldRequest one = {.side = "structure", .field = "von_mises", .dimension = 2, .keys = {}};
  EXPECT_EQ(Read(field_message(plate(0.05), one).bytes()).head["bodies"], Json::array());
  FieldRequest two = one;
  two.parts = {{.name = "left", .first_point = 0}, {.name = "right", .first_point = 2}};
  const Frame frame = plate(0.05);
  const Json bodies = Read(field_message(frame, two).bytes()).head["bodies"];
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_EQ(bodies[0]["name"], "left");
  EXPECT_EQ(bodies[1]["name"], "right");
  EXPECT_EQ(bodies[1]["first"], 2);
  EXPECT_EQ(bodies[0]["low"][0], frame.position.leftCols(2).row(0).minCoeff());
  EXPECT_EQ(bodies[1]["high"][1], frame.position.rightCols(2).row(1).maxCoeff());
}

TEST(SurfaceOf, LeavesOutWhatLiesBetweenTwoCells) {
  Eigen::MatrixXi cells(8, 2);
  cells.col(0) << 0, 1, 2, 3, 4, 5, 6, 7;
  cells.col(1) << 4, 5, 6, 7, 8, 9, 10, 11;
  const Surface two = surface_of(cells, 3);
  EXPECT_EQ(two.triangle.size(), 3U * 2U * 10U);  // ten outer faces of two triangles
  EXPECT_EQ(two.edge.size(), 2U * 20U);
  Eigen::MatrixXi tetrahedron(4, 1);
  tetrahedron << 0, 1, 2, 3;
  EXPECT_EQ(surface_of(tetrahedron, 3).triangle.size(), 3U * 4U);
  EXPECT_EQ(surface_of(tetrahedron, 2).triangle.size(), 3U * 2U);  // in the plane a quadrilateral
}

TEST(FrameCache, ListsWholeFramesAloneAndForgetsThoseThatAreGone) {
  const RunFiles files;
  FrameCache cache(files.path());
  cache.update();
  EXPECT_TRUE(cache.series("fluid").entries.empty());
  FrameSeries series(files.path(), "fluid", 2);
  series.write(water(0));
  series.write(water(0.1));
  put(files.path() / "frames" / "fluid-000002.h5.part", "half of a fr");
  put(files.path() / "frames" / "fluid-000003.h5", "no HDF5 at all");
  put(files.path() / "frames" / "notes.h5", "");
  cache.update();
  ASSERT_EQ(cache.series("fluid").entries.size(), 2U);
  EXPECT_EQ(cache.series("fluid").entries[1].time, 0.1);
  EXPECT_EQ(cache.read("fluid", 1)->time, 0.1);
  EXPECT_EQ(cache.read("fluid", 1), cache.read("fluid", 1));  // kept
  EXPECT_THROW(cache.read("fluid", 2), Error);
  EXPECT_THROW(cache.read("fluid", 3), Error);
  const auto generation = cache.series("fluid").generation;
  series.write(water(0.2));
  cache.update();
  EXPECT_EQ(cache.series("fluid").entries.size(), 3U);
  EXPECT_EQ(cache.series("fluid").generation, generation);
  std::filesystem::remove(files.path() / "frames" / "fluid-000003.h5");  // which a resume would refuse
  series.truncate(0.1);
  cache.update();
  EXPECT_EQ(cache.series("fluid").entries.size(), 2U);
  EXPECT_GT(cache.series("fluid").generation, generation);
}

// A user's program: the page had shown the water alone.
TEST(FrameCache, ShowsTheWetInterfaceOfAStructureWithoutFrames) {
  const RunFiles files;
  FrameSeries series(files.path(), "fluid", 2);
  series.write(water(0));
  series.write(water(0.1));
  InterfaceMesh mesh;
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, 2);
  mesh.position(0, 1) = 1;
  mesh.faces = Eigen::Vector2i(0, 1);
  mesh.parts = {{"left", 0, 0}, {"right", 1, 1}};
  FrameCache cache(files.path());
  cache.update();
  EXPECT_TRUE(cache.series("structure").entries.empty());
  const auto record = [&](int windows, double down) {
    InterfaceRecorder recorder(files.path(), mesh, {});
    for (int k = 0; k < windows; ++k)
      recorder.append({0.05 * k, 0.05}, Points::Constant(3, 2, -down * (k + 1)), Points::Constant(3, 2, -2),
                      Points::Zero(3, 2));
    recorder.flush();
  };
  record(1, 0.1);
  ASSERT_EQ(cache.series("structure").entries.size(), 2U);
  EXPECT_NEAR(cache.read("structure", 1)->position(0, 1), 0.9, 1e-12);  // as far as it is known
  record(2, 0.1);
  const auto frame = cache.read("structure", 1);
  EXPECT_NEAR(frame->position(0, 1), 0.8, 1e-12);
  EXPECT_EQ(frame->time, 0.1);
  EXPECT_EQ(frame->cells, mesh.faces);
  ASSERT_EQ(cache.parts().size(), 2U);
  EXPECT_EQ(cache.parts()[1].name, "right");
  EXPECT_THROW(cache.read("structure", 2), Error);
  // Resumed from the start: the frame is gone, and comes again with other values.
  const std::filesystem::path second = files.path() / "frames/fluid-000001.h5";
  std::filesystem::rename(second, files.path() / "second");
  cache.update();
  std::filesystem::remove_all(files.path() / "interface");
  record(3, 0.2);
  std::filesystem::rename(files.path() / "second", second);
  cache.update();
  EXPECT_NEAR(cache.read("structure", 1)->position(0, 1), 0.6, 1e-12);
  const Read drawn(
      field_message(*frame, {.side = "structure", .field = "", .dimension = 2, .keys = {}}).bytes());
  EXPECT_EQ(drawn.head["arrays"]["edge"]["count"], 2);
  FrameSeries(files.path(), "structure", 2).write(plate(0));
  cache.update();
  EXPECT_EQ(cache.series("structure").entries.size(), 1U);
  EXPECT_GT(cache.read("structure", 0)->position.cols(), 2);
}

}  // namespace frame_message_test
}  // namespace strake::watch
