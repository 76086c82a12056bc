// What of a case's start is seldom meant.

#include "coupler/summary/start.hpp"

#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace start_test {

/// Water 0.5 m deep in a tank of 2 m by 1 m, with one rigid body.
CaseView tank() {
  CaseView view;
  view.fluid = SideView{.side = "fluid", .solver = "mps", .program = {}, .lines = {}, .echo = {}};
  view.structures.push_back(
      SideView{.side = "structure", .solver = "rigid", .program = {}, .lines = {}, .echo = {}});
  view.value = {{"fluid.spacing", "0.01"},
                {"fluid.gravity", "[0, -9.81, 0]"},
                {"fluid.tank", "[[-1, -0.5, 0], [1, 0.5, 0]]"},
                {"fluid.water", "[[-1, -0.5, 0], [1, 0, 0]]"},
                {"structure.mesh", "hull.stl"}};
  return view;
}

/// A body of two points, from one corner of its extent to the other.
InterfaceMesh body(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int dimension = 3) {
  InterfaceMesh mesh;
  mesh.dimension = dimension;
  mesh.position.resize(3, 2);
  mesh.position << low, high;
  return mesh;
}

std::string said(const CaseView& view, const InterfaceMesh& mesh) {
  std::string all;
  for (const std::string& line : start_lines(view, {{view.structures.front().side, &mesh}}))
    all += line + "\n";
  return all;
}

TEST(Start, ABodyInMillimetresIsSaidWithItsKey) {
  EXPECT_EQ(said(tank(), body({0, 0, 0}, {400, 20, 50})), "");
  EXPECT_EQ(
      said(tank(), body({0, 0, 0}, {600, 20, 50})),
      "the body is 600 m long, larger than any ship: lengths are in m; structure.placed.scale = 0.001 is "
      "for a mesh in mm\n");
  EXPECT_EQ(
      said(tank(), body({0, 0, 0}, {120, 20, 0}, 2)),
      "the body is 120 m across, larger than any ship: lengths are in m; structure.placed.scale = 0.001 "
      "is for a mesh in mm\n");
  CaseView two = tank();
  two.structures.front().is_body = true;
  two.structures.front().side = "left";
  EXPECT_EQ(said(two, body({0, 0, 0}, {600, 20, 50})),
            "the body left is 600 m long, larger than any ship: lengths are in m\n");
}

/// A square of 1 m², walked counter-clockwise.
InterfaceMesh square() {
  InterfaceMesh mesh;
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, 4);
  mesh.position.topRows(2) << 0, 1, 1, 0, 0, 0, 1, 1;
  mesh.faces.resize(2, 4);
  mesh.faces << 0, 1, 2, 3, 1, 2, 3, 0;
  return mesh;
}

/// A cube of 8 m³ from (0, 0, 0) on, normals outwards.
InterfaceMesh cube() {
  InterfaceMesh mesh;
  mesh.position = Points::Zero(3, 8);
  for (int k = 0; k < 8; ++k) mesh.position.col(k) << 2 * (k & 1), 2 * (k >> 1 & 1), 2 * (k >> 2 & 1);
  mesh.faces.resize(3, 12);
  mesh.faces << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,            //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

TEST(Start, AFreeBodyOfAnotherUnitOfMassIsSaid) {
  CaseView view = tank();
  view.value["structure.solver"] = "rigid";
  view.value["structure.loaded_faces"] = "[]";
  view.value["structure.mass"] = "5";
  EXPECT_EQ(said(view, square()), "") << "a driven body has any mass";
  view.value["structure.free.y"] = "true";
  EXPECT_EQ(said(view, square()),
            "structure.mass = 5 kg in 1 m^2 are 5 kg/m^3, lighter than foam: masses are in kg per metre of "
            "depth\n");
  EXPECT_EQ(said(view, cube()),
            "structure.mass = 5 kg in 8 m^3 are 0.625 kg/m^3, lighter than foam: masses are in kg\n");
  view.value["structure.lumped.mass"] = "500";
  EXPECT_EQ(said(view, square()), "");
  view.value["structure.mass"] = "3e5";
  EXPECT_NE(said(view, cube()).find("heavier than gold"), std::string::npos);
  view.value["structure.loaded_faces"] = "[\"bottom\"]";
  EXPECT_EQ(said(view, cube()), "") << "the surface is not closed";
}

TEST(Start, ABodyThatIsDrivenToTheFloorIsSaid) {
  CaseView view = tank();
  view.value["structure.velocity"] = "[0, -3, 0]";
  view.common.end_time = 0.1;
  EXPECT_EQ(said(view, square()), "");
  view.common.end_time = 6;
  EXPECT_EQ(
      said(view, square()),
      "structure.velocity drives the body to the floor of the tank at t = 0.167 s: loads after that are "
      "not to be used, and the run ends a spacing deeper, at t = 0.17 s\n");
  view.common.end_time = 0.168;
  EXPECT_EQ(
      said(view, square()),
      "structure.velocity drives the body to the floor of the tank at t = 0.167 s: loads after that are "
      "not to be used\n");
  view.value["structure.free.y"] = "true";
  EXPECT_EQ(said(view, square()), "") << "the water may stop it";
}

TEST(Start, ACentreOfGravityOutsideTheBodyIsSaid) {
  CaseView view = tank();
  view.value["structure.solver"] = "rigid";
  view.value["structure.free.angle"] = "true";
  view.value["structure.centre_of_gravity"] = "[0.5, 1, 0]";
  EXPECT_EQ(said(view, square()), "");
  view.value["structure.centre_of_gravity"] = "[0.5, 1.2, 0]";
  EXPECT_EQ(
      said(view, square()),
      "structure.centre_of_gravity lies outside the body: y = 1.2 m, the body reaches from 0 to 1 m; it is "
      "given where the body starts, after structure.placed\n");
}

// x = A sin 2πft starts with 2πfA: 0.01 m at 0.5 Hz with 0.0314 m/s, 4 degrees with 12.6 deg/s.
TEST(Start, ASineThatStartsAtFullSpeedIsSaid) {
  const InterfaceMesh small = body({0, 0, 0}, {1, 1, 1});
  CaseView view = tank();
  view.value["fluid.motion.frequency"] = "0.5";
  EXPECT_EQ(said(view, small), "") << "no amplitude";
  view.value["fluid.motion.amplitude"] = "0.01";
  view.value["fluid.motion.roll"] = "4";
  EXPECT_EQ(said(view, small),
            "fluid.motion is a sine without ramp: tank and water start at 0.0314 m/s and 12.6 deg/s, 2 pi f "
            "times the amplitude; with fluid.motion.ramp = 2, one period, they start at rest\n");
  view.value["fluid.motion.ramp"] = "2";
  EXPECT_EQ(said(view, small), "");
}

TEST(Start, ATableThatStartsAtSpeedOrJumpsIsSaid) {
  const InterfaceMesh small = body({0, 0, 0}, {1, 1, 1});
  const TemporaryFolder folder;
  CaseView view = tank();
  view.folder = folder.path();
  view.common.end_time = 2;
  view.value["fluid.motion.file"] = "motion.csv";
  const auto with = [&](const std::string& table) {
    put(folder.path() / "motion.csv", table);
    return said(view, small);
  };
  EXPECT_EQ(with("t [s],vx [m/s]\n0,0\n0.5,0.4\n1,0.4\n2,0\n"), "");
  EXPECT_EQ(
      with("t [s],vx [m/s]\n0,0.4\n2,0.4\n"),
      "fluid.motion.file starts at 0.4 m/s: tank and water start with that speed; for water at rest let the "
      "table begin with speed 0 and grow from there\n");
  EXPECT_EQ(with("t [s],vx [m/s]\n0,0\n1,0\n1.001,0.4\n2,0.4\n"),
            "fluid.motion.file: the tank's speed jumps by 0.4 m/s at t = 1 s, within 0.001 s: the water's "
            "pressure is an impulse there, 40.8 g on average; a change over 0.041 s has 1 g\n");
  // The corner is 1.12 m from the pivot: 1 rad/s are 1.12 m/s there.
  EXPECT_EQ(with("t [s],rate [rad/s]\n0,0\n0.001,1\n2,1\n"),
            "fluid.motion.file: the tank's speed jumps by 1.12 m/s at t = 0 s, within 0.001 s: the water's "
            "pressure is an impulse there, 114 g on average; a change over 0.11 s has 1 g\n");
  EXPECT_EQ(with("t [s],vx [m/s]\n0,0\n1.999,0\n3,0\n3.001,9\n"), "") << "after the run's end";
}

TEST(Start, WaterAboveTheFloorIsSaidWhereNothingStandsUnderIt) {
  const InterfaceMesh above = body({0, 0.01, 0}, {1, 0.2, 0});
  CaseView view = tank();
  view.value["fluid.water"] = "[[-1, -0.4, 0], [1, 0, 0]]";
  EXPECT_EQ(said(view, above),
            "the water starts 0.1 m above the floor of the tank, which is at y = -0.5 m, and falls\n");
  EXPECT_EQ(said(view, body({0, -0.45, 0}, {1, -0.4, 0})), "") << "it may stand on the body";
  EXPECT_TRUE(start_lines(view, {}).empty()) << "the body is not known";
  CaseView more = view;
  more.value.merge(flatten_toml("[[fluid.more_water]]\nbox = [[-1, -0.5, 0], [1, -0.4, 0]]\n", "case.toml"));
  EXPECT_EQ(said(more, above), "");
  CaseView weightless = view;
  weightless.value["fluid.gravity"] = "[0, 0, 0]";
  EXPECT_EQ(said(weightless, above), "");
  view.value["fluid.water"] = "[[-1, -0.497, 0], [1, 0, 0]]";
  EXPECT_EQ(said(view, above), "") << "less than half a spacing";
}

CompareBlock block_of(const std::string& probe) {
  CompareBlock block;
  block.probe = probe;
  return block;
}

// A slip in the name of a probe left its reference "not reached" for ever.
TEST(Start, ACompareBlockOfAProbeThatTheRunHasNotIsSaid) {
  CaseView view = tank();
  ProbeKeys tip;
  tip.name = "tip";
  view.common.probes = {tip};
  const std::vector<Column> columns = {{"tip.x", "m"}, {"tip.y", "m"}, {"body.y", "m"}};
  for (const char* known : {"tip.y", "tip.von_mises", "body.y", "force.y"}) {
    view.blocks = {block_of(known)};
    EXPECT_TRUE(judged_lines(view, columns).empty()) << known;
  }
  view.blocks = {block_of("tipp.y")};
  ASSERT_EQ(judged_lines(view, columns).size(), 1u);
  EXPECT_NE(judged_lines(view, columns).front().find("\"tipp.y\""), std::string::npos);
  EXPECT_NE(judged_lines(view, columns).front().find("did you mean tip.y?"), std::string::npos);
  view.blocks.front().when = {{"structure.solver", {"fem"}}};
  view.value["structure.solver"] = "rigid";
  EXPECT_TRUE(judged_lines(view, columns).empty()) << "it does not hold here";
  view.structures.clear();
  view.blocks = {block_of("force.y")};
  EXPECT_EQ(judged_lines(view, columns).size(), 1u) << "water alone has no load on a body";
}

}  // namespace start_test
}  // namespace strake
