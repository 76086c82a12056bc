#include "coupler/summary/resolution.hpp"

#include "coupler/summary/hulls.hpp"
#include "tests/coupler/summary/rigid_in_tank.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake {
namespace resolution_test {

/// A wedge of that half width [m] and slope, its apex at the still level, falling at 6 m/s.
struct Wedge {
  InterfaceMesh mesh;
  Points velocity;
  Wedge(double half, double slope) {
    mesh.dimension = 2;
    mesh.position = Points::Zero(3, 3);
    mesh.position.col(1) << half, slope * half, 0;
    mesh.position.col(2) << -half, slope * half, 0;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 1, 2, 0;
    velocity = Points::Zero(3, 3);
    velocity.row(1).setConstant(-6);
  }
};

TEST(Resolution, CountsSpacingsOnTheHalfWidthThatIsWetAtTheEnd) {
  const Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  EXPECT_NEAR(half_width_below(wedge.mesh, 0.05), 0.05 / std::tan(std::numbers::pi / 6), 1e-12);
  EXPECT_NEAR(half_width_below(wedge.mesh, 1), 0.25, 1e-12) << "not beyond the chines";
  // V t = 0.072 m at 0.012 s: the wetted half width is (π/2) 0.072 / tan 30° = 0.196 m.
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity), "39 spacings"));
  EXPECT_TRUE(says(resolution_lines(case_with(0.01, 0.012), wedge.mesh, wedge.velocity), "some 15 %"));
  EXPECT_TRUE(says(resolution_lines(case_with(0.02, 0.012), wedge.mesh, wedge.velocity), "too few"));
}

TEST(Resolution, TheNarrowerWidthOfABodyInSpaceCounts) {
  InterfaceMesh strip;  // 2 m along x, 0.4 m along z
  strip.dimension = 3;
  strip.position.resize(3, 4);
  strip.position << -1, 1, 1, -1, 0, 0, 0, 0, -0.2, -0.2, 0.2, 0.2;
  strip.faces.resize(3, 2);
  strip.faces << 0, 0, 1, 2, 2, 3;
  EXPECT_NEAR(half_width_below(strip, 0.01), 0.2, 1e-12);
  strip.dimension = 2;
  EXPECT_NEAR(half_width_below(strip, 0.01), 1, 1e-12);
}

/// A pyramid of n sides, its apex at the still level, or a bowl y = r²/2R with radius > 0; falls at 6 m/s.
Wedge turned(double half, double slope, int n, double radius = 0) {
  constexpr int rings = 20;
  Wedge body(half, slope);
  body.mesh.dimension = 3;
  body.mesh.position.setZero(3, rings * n + 1);
  body.mesh.faces.resize(3, 2 * rings * n);
  Eigen::Index face = 0;
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < n; ++i) {
      const double r = half * (k + 1) / rings, angle = 2 * std::numbers::pi * i / n;
      body.mesh.position.col(1 + k * n + i) << r * std::cos(angle),
          radius > 0 ? 0.5 * r * r / radius : slope * r, r * std::sin(angle);
      const int next = (i + 1) % n, below = (k - 1) * n + 1, here = k * n + 1;
      body.mesh.faces.col(face++) << here + i, here + next, k == 0 ? 0 : below + i;
      body.mesh.faces.col(face++) << here + next, k == 0 ? 0 : below + next, k == 0 ? 0 : below + i;
    }
  body.velocity = Points::Zero(3, body.mesh.position.cols());
  body.velocity.row(1).setConstant(-6);
  return body;
}

// V t = 0.06 m at 0.01 s. Wagner's wetted radius of a cone of 45 degrees is 4/π of it, that of a bowl √(3 R V
// t). A pyramid that is twice as long as wide is taken for a wedge, π/2 of V t wide.
TEST(Resolution, ARoundBodyHasItsWettedRadius) {
  const Wedge cone = turned(0.2, 1, 32), bowl = turned(0.2, 0, 32, 0.2);
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.01), cone.mesh, cone.velocity),
                   "15.3 spacings on the wetted radius of 0.0764 m at the end"));
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.01), bowl.mesh, bowl.velocity),
                   "spacings on the wetted radius of 0.19 m at the end"));
  Wedge hull = cone;
  hull.mesh.position.row(2) *= 2;
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.01), hull.mesh, hull.velocity),
                   "18.8 spacings on half the wetted width of 0.0942 m at the end"));
}

// Two hulls 0.2 m wide, 0.6 m apart, under a deck: what lies between them is air.
TEST(Resolution, TheWidthOfACatamaranIsThatOfAHull) {
  InterfaceMesh catamaran;
  catamaran.dimension = 2;
  catamaran.position.setZero(3, 8);
  catamaran.position.topRows(2) << -0.5, -0.3, -0.3, 0.3, 0.3, 0.5, 0.5, -0.5,  //
      0, 0, 0.2, 0.2, 0, 0, 0.3, 0.3;
  catamaran.faces.resize(2, 8);
  for (int k = 0; k < 8; ++k) catamaran.faces.col(k) << k, (k + 1) % 8;
  EXPECT_NEAR(half_width_below(catamaran, 0.1), 0.1, 1e-12);
  EXPECT_NEAR(half_width_below(catamaran, 0.25), 0.5, 1e-12) << "the deck is wet";
  const auto hollow = hollow_below(catamaran, 0.25);
  ASSERT_TRUE(hollow);
  EXPECT_NEAR(hollow->right - hollow->left, 0.6, 1e-12);
  EXPECT_NEAR(hollow->roof - hollow->mouth, 0.2, 0.01);
  EXPECT_FALSE(hollow_below(catamaran, 0.19)) << "its deck is dry";
  Points velocity = Points::Zero(3, 8);
  velocity.row(1).setConstant(-6);
  CaseView view = case_with(0.01, 0.025);  // the water rises by (π/2) 0.15 m over the keels
  const std::string words = "water closes a hollow 0.6 m wide and 0.2 m high: its air is not computed";
  EXPECT_TRUE(says(resolution_lines(view, catamaran, velocity), words));
  view.value["fluid.air.layer"] = "true";
  EXPECT_FALSE(says(resolution_lines(view, catamaran, velocity), words));
  EXPECT_FALSE(says(resolution_lines(case_with(0.01, 0.02), catamaran, velocity), words))
      << "the deck is dry";
  catamaran.position.row(1).array() -= 0.17;  // its hulls stand in the water, the deck 30 mm above it
  EXPECT_TRUE(says(resolution_lines(case_with(0.01, 0.006), catamaran, velocity), words));
  EXPECT_FALSE(says(resolution_lines(case_with(0.01, 0.004), catamaran, velocity), words)) << "it stays dry";
  EXPECT_FALSE(says(resolution_lines(case_with(0.01, 0.006), catamaran, -velocity), words)) << "it rises";
  catamaran.position.row(1).array() -= 0.05;
  EXPECT_FALSE(says(resolution_lines(case_with(0.01, 0.006), catamaran, velocity), words))
      << "water fills it at the start";
}

// Its inner faces are dry. A level surface crosses its outline four times, as that of two hulls.
TEST(Resolution, AHollowWedgeIsOneHull) {
  InterfaceMesh shell;
  shell.dimension = 2;
  shell.position.setZero(3, 6);
  shell.position.topRows(2) << 0, 0.25, 0.25, 0, -0.25, -0.25,  //
      0, 0.1, 0.11, 0.01, 0.11, 0.1;
  shell.faces.resize(2, 6);
  for (int k = 0; k < 6; ++k) shell.faces.col(k) << k, (k + 1) % 6;
  EXPECT_NEAR(half_width_below(shell, 0.05), 0.125, 1e-12);
  EXPECT_FALSE(hollow_below(shell, 0.105)) << "it is open above";
}

TEST(Resolution, ABodyThatFallsFromRestHasItsWidth) {
  Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  wedge.velocity.setZero();
  CaseView view = case_with(0.005, 0.12);
  view.value["fluid.gravity"] = "[0, -9.81, 0]";
  view.value["structure.free.y"] = "true";
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "wetted width"));
  view.common.chosen.from_rest = true;
  // Half the width c = π/2 ½ g t²/tan 30° = 0.192 m.
  EXPECT_TRUE(
      says(resolution_lines(view, wedge.mesh, wedge.velocity), "38 spacings on half the wetted width"));
  view.value["structure.free.y"] = "false";
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "wetted width"));
}

TEST(Resolution, ABodyThatATableDrivesIsNotSaidToStayAway) {
  Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  wedge.velocity.row(1).setConstant(1e-4);  // the slope of the table's spline at t = 0
  CaseView view = case_with(0.005, 0.12);
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "does not reach the water"));
  view.common.chosen.by_table = 2;
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "wetted width"));
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "does not reach the water"));
}

TEST(Resolution, EachOfSeveralBodiesHasItsLines) {
  const Wedge wide(0.25, std::tan(std::numbers::pi / 6)), narrow(0.1, std::tan(std::numbers::pi / 6));
  const auto lines = resolution_lines(
      case_with(0.005, 0.012), {{"port", wide.mesh, wide.velocity}, {"fin", narrow.mesh, narrow.velocity}});
  EXPECT_TRUE(says(lines, "port: 39 spacings on half the wetted width"));
  EXPECT_TRUE(says(lines, "fin: 20.0 spacings on half the wetted width"));
  EXPECT_TRUE(says(lines, "one spacing"));
}

TEST(Resolution, OneOfSeveralBodiesThatFallsFromRestHasItsLines) {
  const Wedge driven(0.25, std::tan(std::numbers::pi / 6));
  Wedge falling = driven;
  falling.velocity.setZero();
  CaseView view = case_with(0.005, 0.12);
  view.value["fluid.gravity"] = "[0, -9.81, 0]";
  view.value["structures.falling.free.y"] = "true";
  view.common.chosen.from_rest = true;
  const auto lines = [&] {
    return resolution_lines(
        view, {{"driven", driven.mesh, driven.velocity}, {"falling", falling.mesh, falling.velocity}});
  };
  EXPECT_TRUE(says(lines(), "falling: 38 spacings on half the wetted width"));
  view.common.chosen.by_table = 2;  // of another body
  EXPECT_TRUE(says(lines(), "falling: 38 spacings on half the wetted width"));
  view.value["structures.falling.motion.file"] = "fall.csv";
  EXPECT_FALSE(says(lines(), "falling:"));
  EXPECT_TRUE(says(lines(), "driven:"));
}

TEST(Resolution, ABodyThatIsDrivenUpwardsDoesNotReachTheWater) {
  Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  const std::string words = "does not reach the water";
  EXPECT_FALSE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity), words));
  wedge.velocity.row(1).setConstant(6);
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity), words));
  CaseView thrown = case_with(0.005, 0.012);
  thrown.value["structure.free.y"] = "true";
  EXPECT_FALSE(says(resolution_lines(thrown, wedge.mesh, wedge.velocity), words));
  thrown.value["fluid.gravity"] = "[0, -9.81, 0]";  // up at 6 m/s it is back after 1.2 s
  EXPECT_TRUE(says(resolution_lines(thrown, wedge.mesh, wedge.velocity), words));
  thrown.common.end_time = 1.3;
  EXPECT_FALSE(says(resolution_lines(thrown, wedge.mesh, wedge.velocity), words));
}

// 6 m/s: the gap of 0.3 m is left behind at 0.05 s.
TEST(Resolution, ABodyThatStaysAwayIsToldWhy) {
  Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  wedge.mesh.position.row(1).array() += 0.3;
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity),
                   "before end_time: at 6 m/s it does at t = 0.05 s"));
  CaseView thrown = case_with(0.005, 0.012);
  thrown.value["structure.free.y"] = "true";
  EXPECT_TRUE(says(resolution_lines(thrown, wedge.mesh, wedge.velocity),
                   "before end_time: it starts 0.3 m above it"));
  wedge.velocity.row(1).setConstant(6);
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity),
                   "before end_time: its velocity points up"));
  wedge.velocity.row(1).setZero();
  wedge.velocity.row(2).setConstant(-6);
  EXPECT_TRUE(says(resolution_lines(case_with(0.005, 0.012), wedge.mesh, wedge.velocity),
                   "before end_time: its velocity is level"));
}

// Half the wetted width is 0.196 m: walls at 1 m and a floor 0.75 m below add 5 % to the impulse.
TEST(Resolution, SaysThatWallsAreNear) {
  const Wedge wedge(0.25, std::tan(std::numbers::pi / 6));
  CaseView view = case_with(0.005, 0.012);
  view.value["fluid.tank"] = "[[-1, -0.75, 0], [1, 0.5, 0]]";
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "walls"));
  view.value["fluid.tank"] = "[[-0.3, -0.75, 0], [0.3, 0.5, 0]]";
  EXPECT_TRUE(
      says(resolution_lines(view, wedge.mesh, wedge.velocity),
           "walls 1.5 and floor 3.8 half wetted widths away: they raise the impulse by some 60 % and the "
           "force at the end to more than twice, by 7 and 14 % where each is 4 away"));
  view.value["fluid.periodic"] = "[\"x\"]";
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "widths away"));
  view.value["fluid.tank"] = "[[-0.3, -0.1, 0], [0.3, 0.5, 0]]";
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity),
                   "floor 0.51 half wetted widths away: they raise the impulse by some 98 % and"));
  view.value["fluid.periodic"] = "[]";
  view.value["fluid.tank"] = "[[-0.2, -0.75, 0], [0.2, 0.5, 0]]";
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "the impulse to more than twice"));
  view.value["fluid.tank"] = "[[-0.3, -0.75, 0], [0.3, 0.5, 0]]";
  view.value["fluid.sound_speed"] = "100";  // 0.6 m before the end, there and back
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "walls 1.5 half wetted"));
  view.value["fluid.sound_speed"] = "10";
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "widths away"));
  const Wedge plate(0.2, 0);  // its width grows no more: a share of the added mass
  view.value["fluid.sound_speed"] = "1500";
  EXPECT_TRUE(
      says(resolution_lines(view, plate.mesh, plate.velocity),
           "walls 1.5 and floor 3.8 half wetted widths away: they raise the impulse by some 28 %, by 4 % "
           "where each is 4 away"));
}

TEST(Resolution, CountsSpacingsThroughTheJet) {
  const Wedge wedge(0.25, std::tan(std::numbers::pi / 12));
  // 15 degrees, V t = 0.036 m at 0.006 s: c = (π/2) 0.036 / tan 15° = 0.211 m, δ = c tan² 15° / 2π = 2.41 mm.
  EXPECT_NEAR(jet_thickness(0.211, std::tan(std::numbers::pi / 12)), 2.41e-3, 1e-5);
  EXPECT_TRUE(says(resolution_lines(case_with(0.008, 0.006), wedge.mesh, wedge.velocity), "0.3 spacings"));
  EXPECT_TRUE(says(resolution_lines(case_with(0.008, 0.006), wedge.mesh, wedge.velocity), "= 0.0024"));
  EXPECT_TRUE(says(resolution_lines(case_with(0.002, 0.006), wedge.mesh, wedge.velocity), "1.2 spacings"));
}

// A bow whose slope falls from 2 to 1: its mean slope tells nothing of the jet, and wedges nothing of its
// force.
TEST(Resolution, AFaceWhoseSlopeChangesIsNotSaidToScatterAsWedgesDo) {
  Wedge bow(0.25, 0.6);
  EXPECT_TRUE(says(resolution_lines(case_with(0.002, 0.012), bow.mesh, bow.velocity), "as that of wedges"));
  bow.mesh.position.resize(3, 5);
  bow.mesh.position << 0, 0.04, 0.25, -0.25, -0.04, 0, 0.08, 0.15, 0.15, 0.08, 0, 0, 0, 0, 0;
  bow.mesh.faces.resize(2, 5);
  bow.mesh.faces << 0, 1, 2, 3, 4, 1, 2, 3, 4, 0;
  bow.velocity = Points::Zero(3, 5);
  bow.velocity.row(1).setConstant(-6);
  const auto lines = resolution_lines(case_with(0.002, 0.012), bow.mesh, bow.velocity);
  EXPECT_TRUE(says(lines, "on a cylinder and on a bow with flare"));
  EXPECT_FALSE(says(lines, "as that of wedges"));
}

// 10 degrees: a jet of 0.1 and 0.2 spacings needs 2π δ/tan²β = 20 and 40 spacings on half the wetted width.
// At 30 degrees the 12 and 30 of all bodies are more.
TEST(Resolution, FlatFacesNeedMoreSpacings) {
  const double end_time = 0.0025, angle = std::numbers::pi / 18;
  const Wedge flat(0.25, std::tan(angle)), steep(0.25, std::tan(3 * angle));
  const double half = 0.5 * std::numbers::pi * 6 * end_time / std::tan(angle);
  const auto lines = [&](double count) {
    return resolution_lines(case_with(half / count, end_time), flat.mesh, flat.velocity);
  };
  EXPECT_TRUE(says(lines(15), "too few for forces: 20 give some 15 %, 40 some 5 %"));
  EXPECT_TRUE(says(lines(25), "mean force to some 15 %, to 5 % from 40 on"));
  EXPECT_TRUE(says(lines(45), "mean force to some 5 %"));
  EXPECT_TRUE(
      says(resolution_lines(case_with(0.005, 0.012), steep.mesh, steep.velocity), "mean force to some 5 %"));
}

// 4 degrees: 2π 0.1/(0.165 tan β) = 54 spacings, and twice as many. A level face needs 12 and 30.
TEST(Resolution, SlopesOfSomeDegreesNeedMoreSpacingsThanALevelFace) {
  const Wedge flat(0.2, std::tan(std::numbers::pi / 45)), level(0.2, 0);
  const auto lines = [&](const Wedge& wedge) {
    return resolution_lines(case_with(0.005, 0.01), wedge.mesh, wedge.velocity);
  };
  EXPECT_TRUE(says(lines(flat),
                   "40 spacings on half the wetted width of 0.2 m at the end: too few for forces: "
                   "54 give some 15 %, 109 some 5 %"));
  EXPECT_TRUE(says(lines(level), "mean force to some 5 %"));
}

// At the chines c = 0.25 m: δ = 0.25 tan² 15° / 2π = 2.86 mm, however long the run goes on.
TEST(Resolution, CountsSpacingsThroughTheJetThatLeavesTheFace) {
  const Wedge wedge(0.25, std::tan(std::numbers::pi / 12));
  for (const double end_time : {0.008, 0.012, 1.0})
    EXPECT_TRUE(says(resolution_lines(case_with(0.008, end_time), wedge.mesh, wedge.velocity),
                     "0.36 spacings through the jet as it leaves the face"));
  const Wedge flat(0.25, 0);
  EXPECT_FALSE(says(resolution_lines(case_with(0.008, 0.012), flat.mesh, flat.velocity), "jet"));
}

// A plate of 0.4 m at half a degree: its outermost points stand on its sides, 4 mm above the lower face.
TEST(Resolution, APlateThatIsNearlyLevelHasNoJet) {
  InterfaceMesh plate;
  plate.dimension = 2;
  plate.position = Points::Zero(3, 4);
  plate.position.topRows(2) << -0.195, 0.195, 0.2, -0.2, 0, 0.0034, 0.0075, 0.004;
  plate.faces.resize(2, 4);
  plate.faces << 0, 1, 2, 3, 1, 2, 3, 0;
  Points velocity = Points::Zero(3, 4);
  velocity.row(1).setConstant(-2.4);
  EXPECT_FALSE(says(resolution_lines(case_with(0.01, 0.012), plate, velocity), "jet"));
}

TEST(Resolution, SaysThatOneSpacingIsNotCheckedAgainstASecond) {
  EXPECT_TRUE(says(resolution_lines(case_with(0.01, 1), {}, {}), "not checked against a second spacing"));
  CaseView dry = case_with(0.01, 1);
  dry.fluid.reset();
  EXPECT_TRUE(resolution_lines(dry, {}, {}).empty());
}

TEST(Resolution, FindsSensorsWiderThanThePeakThatPassesThem) {
  // 10 degrees: at 0.1 m from the keel the peak is 3.2 · 0.1 · tan² 10° = 10 mm wide.
  const double slope = std::tan(std::numbers::pi / 18);
  EXPECT_NEAR(peak_width(0.1, slope), 0.01, 2e-4);
  const Wedge wedge(0.25, slope);
  CaseView view = case_with(0.01, 0.012);
  view.common.probes.push_back(
      {.name = "p", .of = "fluid", .at = {0.1, 0.1 * slope, 0}, .quantity = "pressure", .diameter = 0.02});
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "sensor p"));
  view.common.probes[0].diameter = 0.005;
  EXPECT_FALSE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "sensor p"));
  view.common.probes[0].diameter = 0;  // two spacings
  EXPECT_TRUE(says(resolution_lines(view, wedge.mesh, wedge.velocity), "sensor p"));
}

TEST(Resolution, WantsFourParticleLayersAcrossAPlate) {
  CaseView view = case_with(0.01, 0.012);
  view.structures.front().solver = "particle";
  view.value["structure.plate.thickness"] = "0.02";
  view.value["structure.particle.spacing"] = "0.005";
  EXPECT_FALSE(says(resolution_lines(view, {}, {}), "layers"));
  view.common.interface = "volume";
  EXPECT_TRUE(says(resolution_lines(view, {}, {}), "2 particle layers")) << "there fluid.spacing counts";
}

TEST(Resolution, CountsTheLayersOfEachOfSeveralPlates) {
  CaseView view = case_with(0.01, 0.012);
  SideView& left = view.structures.front();
  left.side = "left";
  left.is_body = true;
  SideView right = left;
  right.side = "right";
  right.solver = "particle";
  view.structures.push_back(right);
  view.value["structures.right.plate.thickness"] = "0.02";
  view.value["structures.right.particle.spacing"] = "0.00555";
  EXPECT_TRUE(says(resolution_lines(view, {}, {}),
                   "right: 3.6 particle layers across the plate: its stiffness needs 4 or more; smaller "
                   "structures.right.particle.spacing"));
}

}  // namespace resolution_test
}  // namespace strake
