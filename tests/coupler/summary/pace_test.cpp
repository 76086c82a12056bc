// What a case costs, and keys that are far from what Strake would take.

#include "coupler/summary/pace.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace strake {
namespace pace_test {

/// A rigid wedge of 10 500 particles at 5 m/s for 10 ms; windows of 1e-4 s, as chosen.
CaseView wedge() {
  CaseView view;
  view.fluid =
      SideView{.side = "fluid",
               .solver = "mps",
               .program = {},
               .lines = {"size   about 10 000 water particles, 500 wall particles, 90 000 places in the "
                         "tank: 60 MB"},
               .echo = {}};
  view.structures.push_back(
      SideView{.side = "structure", .solver = "rigid", .program = {}, .lines = {}, .echo = {}});
  view.common.end_time = 0.01;
  view.common.window = 1e-4;
  view.common.chosen = {.window = 1e-4, .level = false, .speed = 5, .why = "of a reason"};
  view.value = {{"fluid.spacing", "0.01"},         {"fluid.scheme.cfl", "0.2"},
                {"fluid.scheme.time_step", "inf"}, {"fluid.gravity", "[0, 0, 0]"},
                {"fluid.dimension", "2"},          {"fluid.sound_speed", "1500"}};
  return view;
}

using Metrics = std::map<std::string, std::string>;

/// The lines on keys that are far off, of a body 0.5 m long and a case with other values.
std::vector<std::string> lines_with(const Metrics& values, CaseView view = wedge()) {
  for (const auto& [key, value] : values) view.value[key] = value;
  return far_off_lines(view, 0.5);
}

bool says(const std::vector<std::string>& lines, const std::string& words) {
  for (const std::string& line : lines)
    if (line.find(words) != std::string::npos) return true;
  return false;
}

TEST(Pace, CountsStepsParticlesAndMemory) {
  const auto pace = pace_of(wedge());
  ASSERT_TRUE(pace);
  EXPECT_DOUBLE_EQ(pace->step, 1e-4) << "the window; the flow would allow 0.2 l0/(4 V)";
  EXPECT_EQ(pace->steps, 100);
  EXPECT_EQ(pace->particles, 10500);
  EXPECT_DOUBLE_EQ(pace->bytes, 60e6);
  EXPECT_GT(pace->seconds, 0.2);
  EXPECT_LT(pace->seconds, 20);
  CaseView view = wedge();
  view.common.window = 1e-3;
  EXPECT_DOUBLE_EQ(pace_of(view)->step, 1e-4);
  EXPECT_EQ(pace_of(view)->windows, 10);
  view.common.window = 5;  // as long as the run
  EXPECT_EQ(pace_of(view)->windows, 1);
  EXPECT_EQ(pace_of(view)->steps, 100);
  view.common.window = 1e-3;
  const double driven = pace_of(view)->seconds;
  view.value["structure.free.y"] = "true";
  EXPECT_GT(pace_of(view)->seconds, driven) << "iterations";
}

TEST(Pace, TellsWhatTheFramesTakeOnDisk) {
  CaseView view = wedge();  // output.every = 1e-4
  EXPECT_DOUBLE_EQ(pace_of(view)->frame_bytes, 10500 * 85);
  EXPECT_TRUE(says(pace_lines(view), "101 frames (output.every = 0.0001 s): 90 MB on disk"));
  EXPECT_FALSE(says(far_off_lines(view, 0.5), "on disk"));
  view.common.end_time = 1;
  EXPECT_TRUE(says(far_off_lines(view, 0.5),
                   "10 001 frames (output.every = 0.0001 s): 8.9 GB on disk; "
                   "output.every = 0.005 makes 200"));
  view.common.window = 1e-2;  // at most one a window
  EXPECT_TRUE(says(pace_lines(view), "101 frames"));
  EXPECT_FALSE(says(far_off_lines(view, 0.5), "on disk"));
}

TEST(Pace, CountsTheSetUpOfWaterInSpace) {
  CaseView view = wedge();
  view.value["fluid.dimension"] = "3";
  view.common.end_time = view.common.window;                         // a single step
  const double start = 0.1, above = pace_of(view)->seconds - start;  // start: of two programs
  EXPECT_NEAR(above, 10500 * 1.7e-5, 0.01);
  view.value["fluid.submerged"] = "true";
  EXPECT_NEAR(pace_of(view)->seconds - start - above, 10500 * 3.7e-5, 0.01);
}

// A run of one step: what it takes is the start of the programs, the set-up of the water, and its frames.
TEST(Pace, CountsWhatIsNoStep) {
  CaseView view = wedge();
  view.common.end_time = view.common.window;
  const double rigid = pace_of(view)->seconds;
  EXPECT_NEAR(rigid, 0.14, 0.03)
      << "dam_break with one window: 0.08 s, plate_entry with a rigid plate: 0.15 s";
  view.structures.front().solver = "fem";
  EXPECT_NEAR(pace_of(view)->seconds - rigid, 1.05, 0.1) << "the libraries of finite elements, three times";
  view = wedge();
  view.common.end_time = view.common.window;
  view.value["fluid.submerged"] = "true";
  EXPECT_NEAR(pace_of(view)->seconds - rigid, 0.23, 0.05) << "packed water";
  view = wedge();
  view.common.output_every = view.common.end_time;
  const double few = pace_of(view)->seconds;
  view.common.output_every = 1e-4;
  EXPECT_NEAR(pace_of(view)->seconds - few, 0.84, 0.1) << "a hundred frames";
}

// 121 sub-steps in each of 100 windows: 10 000 particles of steel in the plane take 7 s an iteration.
TEST(Pace, CountsTheSubStepsOfElasticParticles) {
  CaseView view = wedge();
  view.structures.front().solver = "particle";
  view.value["structure.material.young"] = "2.1e11";
  view.value["structure.material.density"] = "7800";
  view.value["structure.material.poisson"] = "0.3";
  const double water = pace_of(view)->seconds;
  view.structures.front().lines = {
      "size   about 10 000 particles of the structure 5 mm apart, 90 000 places of its lattice: 60 MB"};
  const double elastic = pace_of(view)->seconds - water;
  EXPECT_GT(elastic, 5);
  EXPECT_LT(elastic, 50);
  view.structures.front().lines = {
      "size   about 20 000 particles of the structure 2.5 mm apart, 90 000 places of its lattice: 60 MB"};
  EXPECT_NEAR((pace_of(view)->seconds - water) / elastic, 4, 0.05);
}

// 100 windows of three iterations: 3 200 unknowns in the plane take a second or two, 42 000 in space four
// minutes, 297 000 with conjugate gradients two hours.
TEST(Pace, CountsTheStepsOfFiniteElements) {
  const auto seconds = [](const char* dimension, const char* size) {
    CaseView view = wedge();
    view.structures.front().solver = "fem";
    view.value["fluid.dimension"] = dimension;
    const double water = pace_of(view)->seconds;
    view.structures.front().lines = {std::string("size   about ") + size +
                                     ", 300 points of the surface: 9 MB"};
    return pace_of(view)->seconds - water;
  };
  EXPECT_NEAR(seconds("2", "400 cells, 3 200 unknowns"), 1.3, 1);
  EXPECT_NEAR(seconds("3", "1 740 cells, 41 760 unknowns"), 250, 100);
  EXPECT_NEAR(seconds("3", "12 384 cells, 297 216 unknowns"), 8000, 3000);
}

TEST(Pace, IsSaidWithItsReasons) {
  const auto lines = pace_lines(wedge());
  EXPECT_TRUE(says(lines, "window 0.0001 s: of a reason"));
  EXPECT_TRUE(says(lines, "10 500 particles"));
  EXPECT_TRUE(says(lines, "60 MB of memory"));
  CaseView view = wedge();
  view.common.window = 2e-4;
  EXPECT_TRUE(says(pace_lines(view), "window 0.0002 s, as given; the default would be 0.0001 s"));
  view.fluid.reset();
  EXPECT_TRUE(pace_lines(view).empty());
}

TEST(Pace, ABodyThatStaysWhileTheTankMovesIsSaid) {
  const auto said = [](const CaseView& view) { return says(far_off_lines(view, 0.5), "moves the tank"); };
  CaseView view = wedge();
  EXPECT_FALSE(said(view));
  view.value["fluid.motion.roll"] = "3";
  EXPECT_TRUE(said(view));
  view.value["structure.motion.file"] = "roll.csv";
  EXPECT_FALSE(said(view));
  view.value.erase("structure.motion.file");
  view.value["structure.free.y"] = "true";
  EXPECT_FALSE(said(view));
}

TEST(Pace, KeysThatAreTwentyTimesOffAreSaid) {
  CaseView view = wedge();
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
  view.common.window = 1e-6;
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "coupling.surface.window = 1e-06 is 1/100 of"))
      << far_off_lines(view, 0.5)[0];
  view.common.window = 3e-3;
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "30 times what Strake would take, 0.0001 s"));
  view.common.chosen.known =
      false;  // a program of the user's: the usual window is no measure of a longer one
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
  view = wedge();
  view.value["fluid.scheme.time_step"] = "2e-6";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "fluid.scheme.time_step = 2e-06 is 1/50 of"));
  view.value["fluid.scheme.time_step"] = "1e-5";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
  EXPECT_TRUE(says(far_off_lines(view, 0.015), "fluid.spacing"));
  EXPECT_TRUE(says(far_off_lines(view, 10), "fluid.spacing"));
  view.value["fluid.sound_speed"] = "20";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "fluid.sound_speed"));
  view.value["fluid.sound_speed"] = "inf";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty()) << "incompressible by choice";
  view.value["fluid.sound_speed"] = "20";
  view.common.preset = "paper";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
}

TEST(Pace, ValuesInAnotherUnitAreSaid) {
  EXPECT_TRUE(says(lines_with({{"fluid.gravity", "[0, 9.81, 0]"}}), "fluid.gravity points up"));
  EXPECT_FALSE(says(lines_with({{"fluid.gravity", "[0, 9.81, 0]"}, {"fluid.open_top", "false"}}),
                    "fluid.gravity points up"));
  EXPECT_TRUE(says(lines_with({{"fluid.gravity", "[-9.81, 0, 0]"}}), "sideways, -9.81 m/s^2 along x"));
  EXPECT_TRUE(says(lines_with({{"fluid.gravity", "[0, 0, -9.81]"}, {"fluid.dimension", "3"}}),
                   "sideways, -9.81 m/s^2 along z"));
  EXPECT_TRUE(lines_with({{"fluid.gravity", "[-2, -9.6, 0]"}}).empty()) << "a tank that leans";
  EXPECT_TRUE(lines_with({{"fluid.gravity", "[0, 0, 0]"}}).empty());
  EXPECT_TRUE(says(lines_with({{"structure.angular_velocity", "-720"}}),
                   "720 rad/s turns the body 1.1 times in the run; 720 deg/s are 12.6 rad/s"));
  EXPECT_TRUE(lines_with({{"structure.angular_velocity", "20"}}).empty());
  EXPECT_TRUE(says(lines_with({{"fluid.gravity", "[0, -9810, 0]"}}),
                   "9.81e+03 m/s^2 is 1000 times that of the earth"));
  EXPECT_TRUE(says(lines_with({{"fluid.density", "1"}}), "fluid.density = 1 is 1/1000 of that of water"));
  EXPECT_TRUE(says(lines_with({{"fluid.kinematic_viscosity", "1"}}), "1 m^2/s is 1e+06 times that of water"));
  EXPECT_TRUE(lines_with({{"fluid.kinematic_viscosity", "5e-5"}}).empty()) << "an oil";
  EXPECT_TRUE(says(lines_with({{"structure.wedge.deadrise", "0.5236"}}),
                   "0.524 deg is nearly level: angles are in degrees, and 0.524 rad are 30"));
  EXPECT_TRUE(lines_with({{"structure.wedge.deadrise", "2"}}).empty());
  CaseView view = wedge();
  view.common.window = view.common.chosen.window = 1e-7;
  view.common.chosen.speed = 5000;
  EXPECT_TRUE(says(lines_with({}, view), "a speed of 5e+03 m/s"));
  EXPECT_FALSE(says(lines_with({}, view), "first pressure of a level face")) << "its steps are short";
}

CaseView elastic_wedge(const std::string& young, const std::string& density) {
  CaseView view = wedge();
  view.structures.front().solver = "fem";
  view.value["structure.material.young"] = young;
  view.value["structure.material.density"] = density;
  return view;
}

TEST(Pace, MaterialsInAnotherUnitAreSaid) {
  CaseView view = elastic_wedge("210", "7.8");
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "softer than a gel"));
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "lighter than foam"));
  view.structures.front().solver = "rigid";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
  for (const char* young : {"2.1e5", "2.1e8"})
    EXPECT_TRUE(says(far_off_lines(elastic_wedge(young, "7850"), 0.5),
                     "softer than any metal, and 7850 kg/m^3 are those of steel"))
        << young;
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("7e7", "2700"), 0.5), "those of aluminium; 70 GPa are 7e10"));
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("3.5e5", "2200"), 0.5), "softer than rubber"));
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("2.1e14", "7800"), 0.5), "stiffer than diamond"));
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("2.1e11", "7.8e5"), 0.5), "heavier than any metal"));
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("7e10", "7800"), 0.5), "that of aluminium, density = 7800"));
  EXPECT_TRUE(says(far_off_lines(elastic_wedge("2.1e11", "2700"), 0.5), "that of steel, density = 2700"));
}

TEST(Pace, MaterialsThatThereAreAreNotSaid) {
  const std::vector<std::pair<const char*, const char*>> known = {
      {"2.1e11", "7850"}, {"7e10", "2700"},    {"1e11", "7200"},  // steel, aluminium, cast iron
      {"1e11", "8500"},   {"1.6e10", "11340"},                    // brass, lead
      {"3e9", "1200"},    {"1e6", "1100"},     {"2e5", "1100"},   // a plastic, rubbers
      {"3e7", "100"},     {"1.2e10", "600"},                      // a foam, wood
      {"1e6", "2500"},    {"1.4e6", "10000"}};                    // soft walls of test cases
  for (const auto& [young, density] : known)
    EXPECT_TRUE(far_off_lines(elastic_wedge(young, density), 0.5).empty()) << young << " " << density;
}

TEST(Pace, MaterialsOfBoxesAndOfSeveralBodiesAreLookedAt) {
  CaseView view = elastic_wedge("2.1e11", "7800");
  for (const char* box : {"[0]", "[1]", "[2]"}) {
    const std::string table = std::string("structure.box") + box + ".material";
    view.value[table + ".young"] = box == std::string("[0]") ? "2.1e11" : "2.1e8";
    view.value[table + ".density"] = "7800";
  }
  ASSERT_EQ(far_off_lines(view, 0.5).size(), 1u) << "two boxes of one material are one line";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "structure.box[1].material.young = 2.1e+08"));
  view = elastic_wedge("2.1e11", "7800");
  view.structures.push_back(view.structures.front());
  for (SideView& side : view.structures) side.is_body = true;
  view.structures[0].side = "left";
  view.structures[0].solver = "rigid";
  view.structures[1].side = "right";
  view.value["structures.left.material.young"] = view.value["structures.right.material.young"] = "210";
  ASSERT_EQ(far_off_lines(view, 0.5).size(), 1u) << "a rigid body";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "structures.right.material.young = 210 Pa"));
  view.fluid.reset();
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "structures.right.material.young")) << "no water";
}

TEST(Pace, APartAlongZIsSaidInThePlane) {
  CaseView view = wedge();
  view.value["fluid.gravity"] = "[0, -9, 81]";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "fluid.gravity = [0, -9, 81] has a part along z"));
  view.value["fluid.dimension"] = "3";
  EXPECT_FALSE(says(far_off_lines(view, 0.5), "has a part along z"));
  view = wedge();
  view.value["structure.velocity"] = "[0, -2, 5]";
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "structure.velocity = [0, -2, 5] has a part along z"));
  view.value["structure.velocity"] = "[0, -2.5, 0]";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
}

TEST(Pace, APlateThatIsThickerThanLongIsSaid) {
  const auto of = [](const char* thickness) {
    return lines_with({{"structure.plate.length", "0.5"}, {"structure.plate.thickness", thickness}});
  };
  EXPECT_TRUE(says(of("10"), "10 m is more than its length, 0.5 m"));
  EXPECT_TRUE(of("0.01").empty());
}

TEST(Pace, ALevelFaceWantsStepsThatResolveItsSound) {
  CaseView view = wedge();
  view.common.window = 1e-4;
  view.common.chosen = {.window = 1e-5, .level = true, .speed = 5, .why = "level"};
  EXPECT_TRUE(says(far_off_lines(view, 0.5), "first pressure of a level face"));
  view.value["fluid.scheme.time_step"] = "1e-5";
  EXPECT_TRUE(far_off_lines(view, 0.5).empty());
}

}  // namespace pace_test
}  // namespace strake
