// The exchange window and the probes of a case that gives neither.

#include "proto/case/window_choice.hpp"

#include "proto/case/case_file.hpp"
#include "proto/case/case_keys.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace strake {
namespace window_choice_test {

const std::string water = R"(
end_time = 0.02
[fluid]
spacing = 0.01
tank = [[-1.0, -0.5], [1.0, 0.5]]
water = [[-1.0, -0.5], [1.0, 0.0]]
)";

CommonKeys read_with(const std::vector<std::string>& sets) {
  CaseFile file = CaseFile::parse(water, "case.toml", sets);
  return read_common(file);
}

double window_with(const std::vector<std::string>& sets) {
  return read_with(sets).window;
}

using Sets = std::vector<std::string>;
const Sets wedge = {"structure.solver=rigid", "structure.wedge.deadrise=30", "structure.velocity=[0,-5]"};
const Sets plate = {"structure.plate.length=0.4", "structure.plate.thickness=0.02",
                    "structure.plate.bottom=[0,0.012]", "structure.velocity=[0,-6]"};

Sets with(Sets sets, const Sets& more) {
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

TEST(WindowChoice, ALevelFaceThatMeetsTheWaterKeepsAcousticWindows) {
  EXPECT_EQ(window_with(plate), 1e-5);
  EXPECT_TRUE(read_with(plate).chosen.level);
  EXPECT_EQ(window_with({"structure.box=[{min=[0,0.1],max=[1,0.2]}]", "structure.velocity=[0,-6]"}), 1e-5);
  EXPECT_EQ(window_with({"structure.solver=./own"}), 1e-5) << "what Strake does not know";
  EXPECT_EQ(window_with({"structure.solver=replay"}), 1e-5);
  EXPECT_EQ(window_with(with(wedge, {"preset=paper"})), 1e-5);
  EXPECT_EQ(window_with({"fluid.solver=none"}), 1e-5);
}

// Such runs on slow water had windows of 1e-5 s, hundreds of times as many as the flow needs.
TEST(WindowChoice, AReplayTakesTheWindowOfItsRecordAndAProgramInTheWaterThatOfTheFlow) {
  const TemporaryFolder folder;
  std::ofstream(folder / "case.toml") << "[coupling.surface]\nwindow = 1.0e-4\n";
  const Sets replay =
      with(wedge, {"structure.solver=replay", "structure.replay.run=" + folder.path().string()});
  EXPECT_EQ(window_with(replay), 1e-4);
  std::ofstream(folder / "case.toml") << "[coupling.surface]\nwindow = 3.0e-5\n";
  EXPECT_EQ(window_with(replay), 2.5e-5);
  EXPECT_FALSE(read_with(replay).chosen.level);
  const Sets own = {"structure.solver=./own", "fluid.submerged=true"};
  EXPECT_FALSE(read_with(own).chosen.level);
  EXPECT_EQ(window_with(own), 2.5e-5) << "as steel of finite elements";
  EXPECT_NE(read_with({"structure.solver=./own"}).chosen.why.find("fluid.submerged"), std::string::npos);
  EXPECT_NE(read_with({"structure.solver=./own"}).chosen.why.find("level impact"), std::string::npos);
}

TEST(WindowChoice, OfSeveralBodiesAnyThatStartsAtRestAndMovesLaterIsKnown) {
  const auto chosen = [](const std::string& first, const std::string& second) {
    const std::string wedge = "\n[structures.wedge]\ndeadrise = 30.0\nwidth = 0.2\n";
    CaseFile file =
        CaseFile::parse(water + "[[structures]]\nname = \"a\"\nsolver = \"rigid\"\n" + first + wedge +
                        "[[structures]]\nname = \"b\"\nsolver = \"rigid\"\n" + second + wedge);
    return read_common(file).chosen;
  };
  const std::string held, falls = "free = { y = true }", driven = "velocity = [0.0, -5.0, 0.0]";
  EXPECT_FALSE(chosen(held, held).from_rest);
  EXPECT_FALSE(chosen(driven, driven).from_rest);
  for (const std::string& other : {held, falls, driven}) {
    EXPECT_TRUE(chosen(other, falls).from_rest) << other;
    EXPECT_TRUE(chosen(falls, other).from_rest) << other;
  }
}

// A stream of 10 m/s past a body that is held, and a body that is towed through water at rest.
TEST(WindowChoice, WaterThatMovesAtTheStartCountsAsTheBody) {
  const Sets held = {"structure.solver=rigid", "structure.wedge.deadrise=30", "fluid.submerged=true"},
             stream = with(held, {"fluid.initial_velocity.value=[10,0]"});
  const double towed = window_with(with(held, {"structure.velocity=[-10,0]"}));
  EXPECT_EQ(read_with(stream).chosen.speed, 10);
  EXPECT_EQ(window_with(stream), towed);
  EXPECT_LT(towed, window_with(held));
  EXPECT_EQ(read_with(with(stream, {"structure.velocity=[-6,0]"})).chosen.speed, 16);
}

TEST(WindowChoice, ABodyThatStartsAtRestAndMovesLaterIsKnown) {
  const Sets at_rest = {"structure.solver=rigid", "structure.wedge.deadrise=30"};
  const Sets falls = with(at_rest, {"structure.free.y=true"});
  EXPECT_TRUE(read_with(falls).chosen.from_rest);
  EXPECT_FALSE(read_with(at_rest).chosen.from_rest) << "it stays where it is";
  EXPECT_FALSE(read_with(with(falls, {"structure.velocity=[0,-5]"})).chosen.from_rest);
  EXPECT_FALSE(read_with(with(falls, {"structure.angular_velocity=1"})).chosen.from_rest);
  EXPECT_FALSE(read_with(with(falls, {"fluid.submerged=true"})).chosen.from_rest) << "it floats";
  EXPECT_FALSE(read_with(with(falls, {"fluid.motion.amplitude=0.1"})).chosen.from_rest);
}

TEST(WindowChoice, AFaceThatDoesNotFallNeedsNoSteps) {
  const Sets held = {"structure.plate.length=1", "structure.plate.supports.left=clamped",
                     "structure.material.young=1e7"};
  EXPECT_FALSE(read_with(held).chosen.level);
  EXPECT_GT(window_with(held), 1e-5);
  EXPECT_TRUE(read_with(with(held, {"structure.free.y=true"})).chosen.level);
  EXPECT_TRUE(read_with(with(held, {"fluid.motion.amplitude=0.1"})).chosen.level);
  EXPECT_FALSE(read_with(with(plate, {"fluid.submerged=true"})).chosen.level);
}

// Such a flap had steps of 2e-6 s for its level upper face: a hundred times as many.
TEST(WindowChoice, AFlapOnTheFloorOfAMovingTankDoesNotFall) {
  const Sets flap = {"structure.box=[{min=[0,-0.5],max=[0.02,-0.3],supports={bottom=\"clamped\"}}]",
                     "structure.material.young=1e7"};
  const Sets moving = with(flap, {"fluid.motion.roll=4", "fluid.motion.frequency=0.5"});
  EXPECT_FALSE(read_with(moving).chosen.level);
  EXPECT_EQ(window_with(moving), window_with(flap));
  EXPECT_TRUE(read_with(with(moving, {"structure.velocity=[0,-1]"})).chosen.level);
  const Sets roof = {"structure.box=[{min=[0,0.1],max=[0.2,0.12],supports={left=\"clamped\"}}]",
                     "fluid.motion.roll=4", "fluid.motion.frequency=0.5"};
  EXPECT_TRUE(read_with(roof).chosen.level) << "the water may slam it";
}

// At 0.25 degrees the wetted edge runs along the plate at 229 V: as fast as sound at 6.6 m/s.
TEST(WindowChoice, APlateTiltedByADegreeIsLevelAsABoxIs) {
  for (const char* angle : {"0.25", "-0.5", "1"})
    EXPECT_EQ(window_with(with(plate, {std::string("structure.plate.angle=") + angle})), 1e-5) << angle;
  EXPECT_FALSE(read_with(with(plate, {"structure.plate.angle=1.5"})).chosen.level);
}

TEST(WindowChoice, ASectionOrAnInclinedBoxHasNoLevelFace) {
  const Sets box = {"structure.box=[{min=[0,0.1],max=[1,0.2]}]", "structure.velocity=[0,-6]"};
  const auto turned = [&box](const std::string& placed) {
    return read_with(with(box, {"structure.placed=" + placed})).chosen.level;
  };
  EXPECT_FALSE(
      read_with({"structure.solver=rigid", "structure.offsets=hull.csv", "structure.velocity=[0,-5]"})
          .chosen.level);
  EXPECT_FALSE(turned("{angle=20}"));
  EXPECT_FALSE(turned("{angle=-20, axis=[1,0,1]}"));
  EXPECT_TRUE(turned("{angle=0.5}"));
  EXPECT_TRUE(turned("{angle=90}"));
  EXPECT_TRUE(turned("{angle=180, axis=[1,0,0]}"));
  EXPECT_TRUE(turned("{angle=30, axis=[0,1,0]}"));
  EXPECT_TRUE(turned("{angle=120, axis=[1,1,1]}")) << "x, y and z change places";
}

TEST(WindowChoice, FollowsSpacingAndSpeed) {
  EXPECT_EQ(window_with(wedge), 1e-4) << "0.05 l0/V";
  EXPECT_EQ(window_with(with(wedge, {"fluid.spacing=0.005"})), 5e-5);
  EXPECT_EQ(window_with(with(wedge, {"structure.velocity=[0,-10]"})), 5e-5);
  EXPECT_EQ(window_with(with(wedge, {"end_time=0.002"})), 2e-5) << "a hundred rows of the history";
  EXPECT_EQ(window_with(with(wedge, {"output.every=4e-5"})), 4e-5);
  EXPECT_EQ(window_with(with(wedge, {"output.every=3e-4", "fluid.spacing=0.008"})), 5e-5) << "divides it";
  const WindowChoice shortened = read_with(with(wedge, {"output.every=1.8e-4"})).chosen;
  EXPECT_EQ(shortened.window, 2e-5) << "1e-4 to 2.5e-5 do not divide it";
  EXPECT_NE(shortened.why.find("; 2e-05 s divides output.every"), std::string::npos) << shortened.why;
  EXPECT_EQ(read_with(with(wedge, {"output.every=4e-4"})).chosen.why.find("output.every"), std::string::npos);
  // A body let go: g end_time is its speed.
  EXPECT_EQ(window_with({"structure.solver=rigid", "structure.cylinder.radius=0.1", "structure.free.y=true",
                         "end_time=0.5"}),
            1e-4);
}

const Sets cylinder = {"structure.solver=rigid", "structure.cylinder.radius=0.1", "structure.free.y=true"};

// The water is 0.5 m deep: √(g H) = 2.2 m/s.
TEST(WindowChoice, ABodyInTheWaterDoesNotFall) {
  const Sets floating = with(cylinder, {"fluid.submerged=true", "end_time=20"});
  EXPECT_NEAR(read_with(floating).chosen.speed, 2.215, 1e-3) << "g end_time is 196 m/s";
  EXPECT_EQ(window_with(floating), 2e-4);
  EXPECT_EQ(window_with(with(floating, {"end_time=40"})), 2e-4) << "whatever the end of the run";
  EXPECT_EQ(read_with(with(floating, {"structure.velocity=[0,-5]"})).chosen.speed, 5) << "it is thrown";
  EXPECT_NEAR(read_with(with(floating, {"end_time=0.01"})).chosen.speed, 0.0981, 1e-4) << "it is let go";
}

// The tank is 1 m high: √(2 g H) = 4.43 m/s.
TEST(WindowChoice, AFallEndsAtTheFloor) {
  EXPECT_NEAR(read_with(with(cylinder, {"end_time=20"})).chosen.speed, 4.429, 1e-3);
  EXPECT_NEAR(read_with(with(cylinder, {"end_time=20", "structure.velocity=[0,-5]"})).chosen.speed, 6.680,
              1e-3);
  EXPECT_NEAR(read_with(with(cylinder, {"end_time=0.1"})).chosen.speed, 0.981, 1e-3);
}

// A ramp from rest to 10 m/s: the section moves as fast as one that structure.velocity drives.
TEST(WindowChoice, FollowsATableOfMotion) {
  const TemporaryFolder folder;
  put(folder / "ramp.csv", "t [s],vy [m/s]\n0,0\n0.001,-10\n0.1,-10\n");
  const Sets section = {"structure.solver=rigid", "structure.offsets=hull.csv",
                        "structure.motion.file=" + (folder / "ramp.csv").string()};
  EXPECT_EQ(read_with(section).chosen.speed, 10);
  EXPECT_EQ(window_with(section), 5e-5) << "0.05 l0/V";
  EXPECT_NEAR(read_with(with(section, {"fluid.motion.roll=3"})).chosen.speed, 2.215, 1e-3)
      << "the tank moves too";
  put(folder / "ramp.csv", "t [s]\n0,0\n");
  EXPECT_NEAR(read_with(section).chosen.speed, 2.215, 1e-3) << "the structure's program refuses the table";
}

// A flap of 0.4 m that turns about its left end, at 20 rad/s: its other end moves at 8 m/s.
TEST(WindowChoice, FollowsTheFastestPointOfABodyThatTurns) {
  const Sets flap = {"structure.solver=rigid", "structure.outline=[[0,0.1],[0.4,0.1],[0.4,0.12],[0,0.12]]",
                     "structure.pivot=[0,0.1]"};
  const double still = window_with(flap);
  const WindowChoice turned = read_with(with(flap, {"structure.angular_velocity=-20"})).chosen;
  EXPECT_EQ(still, 2e-4);
  EXPECT_NEAR(turned.speed, 20 * std::hypot(0.4, 0.02), 1e-12);
  EXPECT_EQ(turned.window, 5e-5) << "0.05 l0/U = 6.2e-5 s";
  EXPECT_NE(turned.why.find("the body's fastest point moves at 8.01 m/s"), std::string::npos) << turned.why;
  EXPECT_NEAR(
      read_with(with(flap, {"structure.angular_velocity=20", "structure.velocity=[0,-5]"})).chosen.speed,
      5 + turned.speed, 1e-12);
  EXPECT_EQ(window_with(with(flap, {"structure.angular_velocity=0.1"})), still) << "slower than waves";
}

TEST(WindowChoice, ATableOfAnglesMovesTheFastestPoint) {
  const TemporaryFolder folder;
  put(folder / "turn.csv", "t [s],rate [rad/s],vy [m/s]\n0,0,-1\n0.001,-20,-1\n0.1,-20,-1\n");
  const Sets box = {"structure.solver=rigid", "structure.outline=[[0,0.1],[0.4,0.1],[0.4,0.12],[0,0.12]]",
                    "structure.pivot=[0,0.1]", "structure.motion.file=" + (folder / "turn.csv").string()};
  const WindowChoice turned = read_with(box).chosen;
  EXPECT_NEAR(turned.by_table, 1 + 20 * std::hypot(0.4, 0.02), 1e-12);
  EXPECT_EQ(turned.window, 5e-5);
  EXPECT_NE(turned.why.find("fastest point"), std::string::npos) << turned.why;
  EXPECT_TRUE(turned.from_rest);
  put(folder / "turn.csv", "t [s],vy [m/s]\n0,-1\n0.1,-1\n");
  EXPECT_EQ(read_with(box).chosen.why.find("fastest point"), std::string::npos);
}

// The farthest point from the axis, of every shape that a case can give.
TEST(WindowChoice, KnowsHowFarABodyReaches) {
  const TemporaryFolder folder;
  const auto reach = [](const Sets& sets) {
    return reach_of_body(CaseFile::parse(water, "case.toml", sets));
  };
  const Sets wedge = {"structure.wedge={deadrise=45, width=0.6, height=0.4, apex=[1,0]}"},
             box = {"structure.box=[{min=[0,0],max=[3,4]}]", "structure.pivot=[0,0]"};
  EXPECT_NEAR(reach(with(wedge, {"structure.pivot=[1,0]"})), 0.5, 1e-12);
  EXPECT_NEAR(reach(wedge), std::hypot(0.3, 0.2), 1e-12) << "about the middle";
  EXPECT_NEAR(reach(with(wedge, {"structure.centre_of_gravity=[1,0.4]"})), 0.4, 1e-12);
  EXPECT_NEAR(reach(box), 5, 1e-12);
  EXPECT_NEAR(reach(with(box, {"structure.placed={scale=0.1, angle=30}"})), 0.5, 1e-12);
  EXPECT_NEAR(reach(with(box, {"structure.placed={move=[3,4]}"})), 10, 1e-12);
  EXPECT_NEAR(reach({"structure.plate={length=0.8, thickness=0.3, bottom=[2,1]}", "structure.pivot=[2,1]"}),
              0.5, 1e-12);
  EXPECT_NEAR(
      reach({"structure.plate={length=0.8, thickness=0.3, bottom=[2,1], angle=20}", "structure.pivot=[2,1]"}),
      0.5, 1e-12);
  EXPECT_EQ(reach({"structure.cylinder={radius=0.2, centre=[0,1]}"}), 0) << "turns within its surface";
  EXPECT_NEAR(reach({"structure.cylinder={radius=0.2, centre=[0,1]}", "structure.pivot=[0,0]"}), 1, 1e-12);
  put(folder / "hull.csv", "station [m],height [m],half_breadth [m]\n0,0,0\n0,0.4,0.3\n1,0,9\n");
  EXPECT_NEAR(reach({"structure.offsets=" + (folder / "hull.csv").string(), "structure.station=0",
                     "structure.pivot=[0,0]"}),
              0.5, 1e-12);
  put(folder / "two.stl",
      "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 3 4 9\n"
      "vertex 1 0 0\nendloop\nendfacet\nendsolid a\n");
  EXPECT_NEAR(reach({"structure.mesh=" + (folder / "two.stl").string(), "structure.pivot=[0,0,5]"}), 5, 1e-6);
  EXPECT_EQ(reach({"structure.mesh=nothing.msh"}), 0);
  EXPECT_EQ(reach({"structure.solver=./own"}), 0);
}

TEST(WindowChoice, FollowsTheStructure) {
  // Aluminium: c = 5092 m/s, twenty spacings in 39 µs; rubber follows the waves, 0.05 l0/√(gH).
  const Sets vee = {"structure.mesh=a.msh", "structure.velocity=[0,-5]", "structure.material.density=2700"};
  EXPECT_EQ(window_with(with(vee, {"structure.material.young=70e9"})), 2.5e-5);
  EXPECT_EQ(window_with(with(vee, {"structure.material.young=2e9"})), 1e-4);
  EXPECT_EQ(
      window_with(with(vee, {"structure.material.young=2e9", "structure.velocity=[0,0]", "end_time=1"})),
      2e-4);
  EXPECT_EQ(read_with({"structure.mesh=a.msh", "structure.initial_velocity.value=[0,-6]"}).chosen.speed, 6);
  EXPECT_NE(read_with(with(vee, {"structure.material.young=70e9"})).chosen.why.find("structure's sound"),
            std::string::npos);
}

// In windows near 4 l0/c a layer of water two rows deep rings under a light body.
TEST(WindowChoice, StepsThatResolveSoundNeedWindowsThatDo) {
  const Sets vee = {"structure.mesh=a.msh", "structure.velocity=[0,-5]", "structure.material.density=2700",
                    "structure.material.young=70e9", "fluid.scheme.time_step=2e-6"};
  EXPECT_EQ(window_with(vee), 1e-5) << "2 l0/c";
  EXPECT_NE(read_with(vee).chosen.why.find("the water's sound"), std::string::npos);
  EXPECT_EQ(window_with(with(vee, {"fluid.sound_speed=inf"})), 2.5e-5);
  EXPECT_EQ(window_with(with(vee, {"fluid.scheme.time_step=1e-5"})), 2.5e-5) << "c dt = 1.5 l0";
  EXPECT_EQ(window_with(with(wedge, {"fluid.scheme.time_step=2e-6"})), 1e-4) << "a driven rigid body";
  const Sets fine = with(plate, {"fluid.spacing=0.0025", "fluid.scheme.time_step=1e-6"});
  EXPECT_EQ(window_with(fine), 2.5e-6);
  EXPECT_EQ(window_with(with(fine, {"structure.solver=rigid"})), 1e-5);
  EXPECT_EQ(window_with(with(fine, {"fluid.scheme.time_step=inf"})), 1e-5);
}

TEST(WindowChoice, WaterAloneHasFourHundredRows) {
  EXPECT_EQ(window_with({"structure.solver=none", "end_time=4"}), 1e-2);
}

TEST(WindowChoice, AGivenKeyIsStronger) {
  EXPECT_EQ(window_with(with(wedge, {"coupling.surface.window=3e-6"})), 3e-6);
  EXPECT_EQ(read_with(with(wedge, {"coupling.surface.window=3e-6"})).chosen.window, 1e-4);
  EXPECT_EQ(window_with(with(wedge, {"fluid.scheme.time_step=5e-4"})), 5e-4) << "a step fits into a window";
}

TEST(WindowChoice, RoundsToPlainNumbers) {
  EXPECT_EQ(round_window(9.9e-5), 5e-5);
  EXPECT_EQ(round_window(1e-4), 1e-4);
  EXPECT_EQ(round_window(4.9e-5), 4e-5);
  EXPECT_EQ(round_window(4.9e-5, 5e-4), 2.5e-5) << "divides half a millisecond";
  EXPECT_EQ(round_window(30), 25);
}

std::string names(const CommonKeys& keys) {
  std::string text;
  for (const ProbeKeys& probe : keys.probes) text += probe.name + ":" + probe.quantity + " ";
  return text;
}

TEST(DefaultProbes, APlateHasItsDeflectionAndThePressureBelow) {
  const CommonKeys keys = read_with(plate);
  ASSERT_EQ(names(keys), "middle:deflection p_middle:pressure ");
  EXPECT_EQ(keys.probes[0].at, Eigen::Vector3d(0, 0.022, 0));
  EXPECT_EQ(keys.probes[1].at, Eigen::Vector3d(0, 0.012, 0));
  EXPECT_EQ(names(read_with(with(plate, {"structure.solver=rigid"}))), "p_middle:pressure ");
  EXPECT_EQ(names(read_with(with(plate, {"fluid.solver=none"}))), "middle:deflection ");
  EXPECT_EQ(names(read_with(with(plate, {"structure.plate.bottom=[0,2]"}))), "middle:deflection ")
      << "no sensor outside the tank";
  EXPECT_EQ(names(read_with(wedge)), "");
}

TEST(DefaultProbes, GiveWayToThoseOfTheCase) {
  EXPECT_EQ(names(read_with(with(plate, {"output.default_probes=false"}))), "");
  EXPECT_EQ(names(read_with(with(plate, {"output.probe[0].name=tip", "output.probe[0].of=structure",
                                         "output.probe[0].at=[0,0]"}))),
            "tip:deflection ");
}

}  // namespace window_choice_test
}  // namespace strake
