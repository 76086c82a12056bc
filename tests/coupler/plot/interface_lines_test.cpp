// Pictures of a body without frames of its own.
#include "coupler/plot/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::picture {
namespace interface_lines_test {

/// A floor of two faces that goes down by 0.1 m in a window of 1 s.
InterfaceRecord floor_record(int dimension) {
  InterfaceRecord record;
  record.mesh = {"floor", dimension, Points::Zero(3, 3), {}, {}};
  record.mesh.position.row(0) << 0, 1, 2;
  if (dimension == 2) {
    record.mesh.faces.resize(2, 2);
    record.mesh.faces << 0, 1, 1, 2;
  } else {
    record.mesh.position.row(2) << -1, 1, -1;
    record.mesh.faces.resize(3, 1);
    record.mesh.faces << 0, 1, 2;
  }
  Points down = Points::Zero(3, 3);
  down.row(1).setConstant(-0.1);
  record.initial_displacement = record.initial_velocity = Points::Zero(3, 3);
  record.append({0, 1}, down, down, Points::Zero(3, 3));
  return record;
}

RunFrames run_with(InterfaceRecord record) {
  RunFrames run;
  run.folder = "runs/floor";
  run.keys = {{"structure.solver", "./floor.py"}};
  run.interface = std::make_shared<const InterfaceRecord>(std::move(record));
  return run;
}

TEST(InterfaceLines, DrawTheWetSurfaceWhereItIs) {
  Scene scene;
  scene.time = 1;
  draw_interface(run_with(floor_record(2)), "", std::nullopt, scene);
  ASSERT_EQ(scene.lines.size(), 2U);
  EXPECT_DOUBLE_EQ(scene.lines[1][1].x, 2);
  EXPECT_DOUBLE_EQ(scene.lines[1][1].y, -0.1);
  EXPECT_DOUBLE_EQ(scene.x.hi, 2) << "the view holds it";
  EXPECT_EQ(scene.notes, std::vector<std::string>{"structure has no frames: its wet surface is drawn"});
}

TEST(InterfaceLines, OfABodyInSpaceAreCut) {
  Scene scene;
  scene.time = 1;
  draw_interface(run_with(floor_record(3)), "", 0.0, scene);
  ASSERT_EQ(scene.lines.size(), 1U);
  EXPECT_DOUBLE_EQ(std::abs(scene.lines[0][1].x - scene.lines[0][0].x), 1);
}

TEST(InterfaceLines, ShowPointsWhereThereAreNoFaces) {
  Scene scene;
  scene.spacing = 0.5;
  scene.time = 1;
  InterfaceRecord record = floor_record(2);
  record.mesh.faces.resize(2, 0);
  draw_interface(run_with(record), "", std::nullopt, scene);
  EXPECT_EQ(scene.solid.size(), 3U);
  EXPECT_TRUE(scene.lines.empty());
}

TEST(InterfaceLines, SayWhereThereIsNothingToDraw) {
  Scene scene;
  RunFrames run = run_with(floor_record(2));
  draw_interface(run, "left", std::nullopt, scene);
  run.interface = nullptr;
  draw_interface(run, "", std::nullopt, scene);
  ASSERT_EQ(scene.notes.size(), 2U);
  EXPECT_EQ(scene.notes[0],
            "left has no frames: the run's files do not hold its surface, the water alone is drawn");
  run.keys["structure.solver"] = "none";
  draw_interface(run, "", std::nullopt, scene);
  EXPECT_EQ(scene.notes.size(), 2U) << "water alone is what was asked for";
}

}  // namespace interface_lines_test
}  // namespace strake::picture
