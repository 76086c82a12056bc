#include "proto/case/case_file.hpp"
#include "proto/error.hpp"
#include "proto/geometry/face_direction.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/mechanism.hpp"
#include "structure/body/parameters.hpp"
#include "structure/body/surface.hpp"
#include "structure/case/read_parameters.hpp"
#include "structure/rigid/support_frame.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace strake::structure {
namespace solid_keys_test {

/// A case with that [structure] part; `more` goes to the end.
CaseFile body_case(const std::string& structure, const std::vector<std::string>& sets = {},
                   const std::string& name = "case.toml") {
  return CaseFile::parse(
      "end_time = 0.5\n[fluid]\nspacing = 0.01\n[structure]\nsolver = \"rigid\"\n" + structure, name, sets);
}

Parameters read_body(const std::string& structure, const std::vector<std::string>& sets = {},
                     const std::string& kind = "rigid", const std::string& name = "case.toml") {
  CaseFile file = body_case(structure, sets, name);
  Parameters p = read(file, kind);
  file.refuse_unknown("structure");
  return p;
}

void refuses(const std::string& structure, const std::string& part, const std::vector<std::string>& sets = {},
             const std::string& kind = "rigid", const std::string& name = "case.toml") {
  try {
    read_body(structure, sets, kind, name);
    ADD_FAILURE() << structure << " was accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_NE(to_text(e).find(part), std::string::npos) << to_text(e);
    EXPECT_NE(to_text(e).find("fix:"), std::string::npos) << to_text(e);
    if (e.where().find("motion.csv") == std::string::npos) {
      EXPECT_NE(e.where().find("case.toml"), std::string::npos) << to_text(e);
    }
  }
}

double volume_of_body(const Parameters& p) {
  const InterfaceMesh mesh = surface(p);
  return enclosed_volume(mesh.faces, mesh.position);
}

TEST(BodyKeys, AnElasticBodyOfWhichAllPartsAreHeldIsRefused) {
  const std::string body =
      "box = [{ name = \"a\", min = [0, 0], max = [1, 0.1], supports = { all = true } }%]\nparticle.spacing "
      "= 0.025\n";
  const auto with = [&](const std::string& more) {
    std::string text = body;
    return text.replace(text.find('%'), 1, more);
  };
  for (const char* solver : {"fem", "particle", "ccx"})
    refuses(with(""), "all parts of the body are held", {}, solver);
  EXPECT_EQ(read_body(with("")).solid.parts.size(), 1U) << "a rigid body has no need to deform";
  const std::string free = ", { name = \"b\", min = [1, 0], max = [2, 0.1] }";
  EXPECT_EQ(read_body(with(free), {}, "fem").solid.parts.size(), 2U);
}

TEST(BodyKeys, ABodyOfBoxesIsScaledThenTurnedThenMoved) {
  const std::string box = "box = [{ name = \"a\", min = [0, 0], max = [200, 10] }]\nmaterial.density = 100\n";
  const Parameters p = read_body(box + "placed = { scale = 0.001, angle = 90, move = [1, 2] }\n");
  const MassProperties mass = mass_of(p.solid);
  EXPECT_NEAR(mass.mass, 100 * 0.2 * 0.01, 1e-12);
  EXPECT_LT((mass.centre - Eigen::Vector3d(1 - 0.005, 2 + 0.1, 0)).norm(), 1e-12);
  EXPECT_TRUE(p.solid.made_of_boxes());
  EXPECT_FALSE(p.solid.along_axes());
  const Parameters moved = read_body(box + "placed = { scale = 0.001, move = [1, 2] }\n", {}, "fem");
  ASSERT_TRUE(moved.solid.along_axes());
  EXPECT_NEAR(moved.solid.plane[0].back(), 1.2, 1e-12);
  refuses("plate = { length = 0.4, thickness = 0.02 }\nplaced.angle = 10\n", "structure.plate.angle");
}

// A wedge or an outline heels as a section of offsets does: first scaled, then turned, then moved.
// "did you mean left?" was the answer to "left".
TEST(BodyKeys, ASideWithoutAFaceIsToldWhy) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "cell.inp";
  std::ofstream(file)
      << "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPE4, ELSET=a\n1, 1, 2, 3, 4\n";
  const std::string mesh = "mesh = \"" + file.string() + "\"\n", left = "support = [{ on = \"left\" }]\n";
  EXPECT_NO_THROW(read_body(mesh + left, {}, "fem"));
  refuses(mesh + "placed.angle = 10\n" + left, "has a point or an edge, and no face", {}, "fem");
  refuses(mesh + "support = [{ on = \"lef\" }]\n", "did you mean \"left\"?", {}, "fem");
}

TEST(BodyKeys, AnOutlineOrAWedgeIsScaledThenTurnedThenMoved) {
  const std::string placed =
                        "material.density = 100\nplaced = { scale = 0.001, angle = 90, move = [1, 2] }\n",
                    outline = "outline = [[0, 0], [200, 0], [200, 100], [0, 100]]\n";
  const MassProperties box = mass_of(read_body(outline + placed));
  EXPECT_NEAR(box.mass, 100 * 0.2 * 0.1, 1e-12);
  EXPECT_LT((box.centre - Eigen::Vector3d(1 - 0.05, 2 + 0.1, 0)).norm(), 1e-12);
  const std::string wedge =
      "wedge = { deadrise = 30, width = 0.5, apex = [0, 0.1] }\nmaterial.density = 100\n";
  const MassProperties upright = mass_of(read_body(wedge)),
                       heeled = mass_of(read_body(wedge + "placed.angle = 90\n"));
  EXPECT_NEAR(heeled.mass, upright.mass, 1e-9);
  EXPECT_NEAR(heeled.centre.x(), -upright.centre.y(), 1e-12);
  refuses("cylinder = { radius = 0.1 }\nplaced.angle = 10\n", "placed.angle");
}

// Otherwise the body is seen from the side and gets narrower, without a word.
TEST(BodyKeys, ABodyInThePlaneTurnsInThePlane) {
  const std::string placed = "placed = { angle = 20, axis = [1, 0, 0] }\n";
  refuses("box = [{ name = \"a\", min = [0, 0], max = [1, 1] }]\n" + placed, "a body turns in the plane");
  refuses("outline = [[0, 0], [1, 0], [0, 1]]\n" + placed, "turns in its plane");
  EXPECT_NO_THROW(
      read_body("outline = [[0, 0], [1, 0], [0, 1]]\nplaced = { angle = 20, axis = [0, 0, -1] }\n"));
}

// Its face is a parabola, whose mean depth is a third of that of its ends.
TEST(BodyKeys, AHollowPlateHasAParabolaBelow) {
  const std::string plate = "plate = { length = 0.4, thickness = 0.02, bottom = [1, 2], hollow = ";
  for (const double hollow : {0.003, -0.003}) {
    const Parameters p = read_body(plate + std::to_string(hollow) + " }\nmaterial.density = 100\n");
    EXPECT_EQ(p.shape.kind, ShapeKind::polygon);
    const double below = 0.4 * hollow / 3;
    EXPECT_NEAR(mass_of(p.shape, p.plate, 100).mass, 100 * (0.4 * 0.02 + below), 100 * 1e-3 * 0.4 * 0.003);
  }
  refuses(plate + "0.02 }\n", "less than the thickness");
  EXPECT_THROW(read_body(plate + "0.001 }\n", {}, "fem"), Error);
}

// Turned about the middle of its lower face: mass and inertia are those of the level plate, the ends stay
// ends.
TEST(BodyKeys, APlateAtAnAngleIsTheLevelOneTurned) {
  const std::string plate =
      "plate = { length = 0.4, thickness = 0.02, bottom = [1, 2], supports = { left = \"pinned\" }, ";
  const Parameters p = read_body(plate + "angle = 30 }\n", {}, "fem");
  const double sine = 0.5, cosine = std::sqrt(0.75);
  const MassProperties level = mass_of(read_body(plate + "angle = 0 }\n").shape,
                                       read_body(plate + "angle = 0 }\n").plate, 7800),
                       turned = mass_of(p.solid);
  EXPECT_NEAR(turned.mass, level.mass, 1e-9 * level.mass);
  EXPECT_NEAR(turned.inertia(2, 2), level.inertia(2, 2), 1e-9 * level.inertia(2, 2));
  EXPECT_LT((turned.centre - Eigen::Vector3d(1 - 0.01 * sine, 2 + 0.01 * cosine, 0)).norm(), 1e-12);
  ASSERT_EQ(p.solid.supported.size(), 1u);
  EXPECT_EQ(p.solid.supported.front().support, Support::pinned);
  EXPECT_LT((middle_of(p.solid, p.solid.supported.front()) -
             Eigen::Vector3d(1 - 0.2 * cosine - 0.01 * sine, 2 - 0.2 * sine + 0.01 * cosine, 0))
                .norm(),
            1e-12);
  EXPECT_LT(
      (shorter_direction(p.solid, p.solid.supported.front()).cwiseAbs() - Eigen::Vector3d(sine, cosine, 0))
          .norm(),
      1e-12);
  refuses(plate + "angle = 90 }\n", "-89 to 89", {}, "fem");
  refuses(plate + "angle = 30 }\n", "depth", {"fluid.dimension=3"}, "fem");
  const Parameters thick = read_body(plate + "angle = 30 }\ndepth = 0.2\n", {"fluid.dimension=3"}, "fem");
  EXPECT_NEAR(mass_of(thick.solid).mass, 0.2 * level.mass, 1e-9 * level.mass);
  EXPECT_GT(surface(thick).position.cols(), 400);  // points a spacing apart on the turned faces too
}

// The case.toml of a run contains every key, the tables of rigid bodies with their defaults too.
TEST(BodyKeys, TheResolvedCaseOfAnElasticBodyIsACase) {
  const std::string plate = "plate = { length = 0.4, thickness = 0.02 }\n";
  for (const std::string kind : {"fem", "particle"}) {
    CaseFile file = body_case(plate, {"structure.solver=" + kind, "structure.particle.spacing=0.005"});
    read(file, kind);
    CaseFile again = CaseFile::parse(file.echo());
    EXPECT_NO_THROW(read(again, kind)) << file.echo();
  }
  refuses(plate + "lumped = { mass = 1 }\n", "structure.lumped", {}, "fem");
}

TEST(BodyKeys, AWedgeIsGivenByWidthOrByDraught) {
  const Parameters a = read_body("wedge = { deadrise = 45, width = 0.4, apex = [0, 0.1], height = 0.3 }\n");
  ASSERT_EQ(a.shape.corner.size(), 5u);
  EXPECT_NEAR(a.shape.corner[1].y(), 0.3, 1e-15);
  EXPECT_NEAR(a.shape.corner[2].y(), 0.4, 1e-15);
  const Parameters b = read_body("wedge = { deadrise = 30, draught = 0.1, apex = [0, 0.1] }\n");
  EXPECT_NEAR(b.shape.corner[1].x(), 0.1 / std::tan(std::numbers::pi / 6), 1e-15);
  const Parameters steep =
      read_body("wedge = { deadrise = 30, width = 0.5 }\n", {"structure.wedge.deadrise=45"});
  EXPECT_NEAR(steep.shape.corner[1].y(), 0.25, 1e-15);
}

TEST(BodyKeys, OutlineCylinderAndSphereAreShapes) {
  const Parameters p = read_body("outline = [[0, 0], [0.4, 0], [0.4, 0.2], [0, 0.2]]\n");
  EXPECT_NEAR(volume_of_body(p), 0.08, 1e-15);
  const Parameters c = read_body("cylinder = { radius = 0.1, centre = [0, 0.1] }\n");
  EXPECT_NEAR(volume_of_body(c), std::numbers::pi * 0.01, 1e-15);
  const Parameters s = read_body("sphere = { radius = 0.1 }\n", {"fluid.dimension=3"});
  EXPECT_NEAR(volume_of_body(s), 4.0 / 3 * std::numbers::pi * 0.001, 1e-15);
  const Parameters w =
      read_body("wedge = { deadrise = 30, width = 0.5 }\ndepth = 1.0\n", {"fluid.dimension=3"});
  EXPECT_EQ(surface(w).dimension, 3);
  const Parameters b =
      read_body("plate = { length = 0.4, thickness = 0.1 }\ndepth = 0.3\n", {"fluid.dimension=3"});
  EXPECT_NEAR(volume_of_body(b), 0.012, 1e-15);
}

TEST(BodyKeys, OffsetsFinerThanTheWaterAreRead) {
  const Parameters short_side =
      read_body("outline = [[0, 0], [0.4, 0], [0.4, 0.2], [0.399, 0.2], [0, 0.2]]\n");
  EXPECT_EQ(short_side.shape.corner.size(), 4u);
  EXPECT_EQ(short_side.shape.unseen, 1);
  std::string points;
  for (int k = 0; k < 720; ++k) {
    const double angle = k * std::numbers::pi / 360;
    points += fmt::format("{}[{}, {}]", k == 0 ? "" : ", ", 0.15 * std::cos(angle), 0.15 * std::sin(angle));
  }
  for (const char* scale : {"1", "2"}) {
    const Parameters p = read_body("outline = [" + points + "]\nplaced = { scale = " + scale + " }\n");
    const double radius = 0.15 * std::stod(scale);
    EXPECT_LT(p.shape.corner.size(), 240u);
    EXPECT_EQ(std::ssize(p.shape.corner) + p.shape.unseen, 720);
    for (const Eigen::Vector2d& x : p.shape.corner) EXPECT_NEAR(x.norm(), radius, 1e-9);
    EXPECT_NEAR(volume_of_body(p), std::numbers::pi * radius * radius, 0.004 * radius * radius);
  }
}

TEST(BodyKeys, MassInertiaAndFreedomAreRead) {
  const Parameters p = read_body(
      "mass = 241.0\ninertia = 5.0\ncentre_of_gravity = [0.0, 0.2]\nfree = { y = true, angle = true }\n"
      "lumped = { mass = 2.0, at = [0.0, 0.1] }\nangular_velocity = 0.5\n"
      "wedge = { deadrise = 30, width = 0.5 }\n");
  EXPECT_EQ(mass_of(p).mass, 243);
  EXPECT_NEAR(mass_of(p).centre.y(), (241 * 0.2 + 0.2) / 243, 1e-15);
  EXPECT_TRUE(p.free.y && p.free.angle && !p.free.x);
  EXPECT_EQ(p.angular_velocity, 0.5);
}

TEST(BodyKeys, WrongShapesAreRefusedWithPlaceAndRemedy) {
  refuses("outline = [[0, 0], [0.4, 0.2], [0.4, 0], [0, 0.2]]\n", "crosses");
  refuses("outline = [[0, 0], [0, 0.2], [0.4, 0.2], [0.4, 0]]\n", "opposite order");
  refuses("outline = [[0, 0], [0.4, 0]]\n", "at least 3 points");
  refuses("wedge = { deadrise = 30 }\n", "one of width and draught");
  refuses("wedge = { deadrise = 30, width = 0.5, draught = 0.1 }\n", "leave draught out");
  refuses("wedge = { deadrise = 30, width = 0.5, height = 0.1 }\n", "height = 0.144338");
  refuses("wedge = { width = 0.5 }\n", "deadrise");
  refuses("wedge = { deadrise = 88, width = 0.5 }\n", "at most 85");
  refuses("cylinder = { radius = 0.015 }\n", "at least twice");
  refuses("cylinder = { radius = 0 }\n", "greater than 0");
  refuses("sphere = { radius = 0.1 }\n", "structure.cylinder");
  refuses("wedge = { deadrise = 30, width = 0.5 }\n", "along z", {"fluid.dimension=3"});
  refuses("wedge = { deadrise = 30, width = 0.5 }\ncylinder = { radius = 0.1 }\n", "one shape");
  refuses("wedge = { deadrise = 30, width = 0.5 }\nplate = { length = 1, thickness = 0.1 }\n", "one shape");
  refuses("wedge = { deadrise = 30, width = 0.5 }\n", "structure.solver = \"rigid\"", {}, "fem");
  refuses("wedge = { deadrise = 30, width = 0.5 }\nload = { kind = \"traction\", value = [0, 1] }\n",
          "point");
  refuses("", "length");
}

TEST(BodyKeys, WrongMassesAndMotionsAreRefusedWithPlaceAndRemedy) {
  const std::string wedge = "wedge = { deadrise = 30, width = 0.5 }\n",
                    plate = "plate = { length = 1, thickness = 0.1 }\n";
  refuses(wedge + "mass = 0\n", "greater than 0");
  refuses(wedge + "mass = -3\n", "greater than 0");
  refuses(wedge + "inertia = 0\n", "greater than 0");
  refuses(wedge + "lumped = { mass = -1 }\n", "at least 0");
  refuses(wedge + "inertia_axes = [1, 1, 1]\n", "two dimensions");
  refuses(wedge + "free = { z = true }\n", "two dimensions");
  refuses(wedge + "free = { rotation = true }\n", "two dimensions");
  refuses(wedge + "free = { angel = true }\n", "did you mean angle");
  refuses(wedge + "free = { y = true }\npivot = [0, 0]\n", "pivot");
  refuses(wedge + "depth = 1\nfree = { angle = true, rotation = true }\n", "one of angle and rotation",
          {"fluid.dimension=3"});
  refuses(wedge + "depth = 1\ninertia_axes = [1, 1, 3]\n", "sum of the other two", {"fluid.dimension=3"});
  refuses("sphere = { radius = 0.1 }\ndepth = 1\n", "their own lengths along z", {"fluid.dimension=3"});
  refuses("box = [{ name = \"floor\", min = [0, 0, 0], max = [1, 0.1, 1] }]\ndepth = 1\n",
          "their own lengths along z", {"fluid.dimension=3"}, "fem");
  refuses(plate + "mass = 3\n", "rigid bodies", {}, "fem");
  refuses("", "water alone: solver = \"none\"", {}, "fem");
}

// What an elastic body's supports stand in moves by a table or freely, and turns by a table alone.
TEST(BodyKeys, TheFrameOfAnElasticBodyIsDrivenOrFree) {
  const TemporaryFolder folder;
  const std::string name = (folder / "case.toml").string(),
                    held = "plate = { length = 0.4, thickness = 0.02, supports = { left = \"clamped\" } }\n",
                    floating = "plate = { length = 0.4, thickness = 0.02 }\n",
                    table = "motion = { file = \"motion.csv\" }\n";
  const Parameters p =
      read_body(held + "free = { y = true }\nlumped = { mass = 3 }\nvelocity = [0, -2]\n", {}, "particle");
  EXPECT_TRUE(p.free.y);
  EXPECT_EQ(p.body.lumped_mass, 3);
  const std::string no_effect =
      notes_on_unheld(read_body(floating + "free = { y = true }\n", {}, "fem")).at(0);
  EXPECT_NE(no_effect.find("structure.free has no effect"), std::string::npos) << "it floats as it is";
  EXPECT_EQ(notes_on_unheld(read_body(floating, {}, "ccx")), std::vector<std::string>{nothing_holds});
  EXPECT_TRUE(notes_on_unheld(read_body(floating, {}, "fem")).empty()) << "it says so itself";
  EXPECT_TRUE(notes_on_unheld(read_body(held + "free = { y = true }\n", {}, "ccx")).empty());
  refuses(held + "lumped = { mass = 3 }\n", "structure.free.y = true", {}, "fem");
  refuses(floating + "free = { y = true }\nlumped = { mass = 3 }\n", "no supports", {}, "fem");
  refuses(held + "free = { angle = true }\n", "turn by a table alone", {}, "fem");
  refuses(held + "free = { y = true }\nanalysis = \"modal\"\n", "supports are at rest", {}, "fem");
  put(folder / "motion.csv", "t [s],vy [m/s]\n0,0\n0.25,-1\n0.5,-3\n");
  EXPECT_NEAR(read_body(held + table, {}, "fem", name).motion->at(0.5).velocity.y(), -3, 1e-15);
  refuses(floating + table, "no supports", {}, "fem", name);
  refuses(held + table + "free = { y = true }\n", "prescribes this motion", {}, "particle", name);
  refuses(held + table, "end_time = 0.5", {"end_time=0.6"}, "fem", name);
  put(folder / "motion.csv", "t [s],angle [deg]\n0,0\n0.5,1\n");
  refuses(held + table, "what the supports turn about", {}, "fem", name);
  const std::string turned = held + table + "pivot = [-0.2, 0.0]\n";
  EXPECT_TRUE(read_body(turned, {}, "fem", name).motion->turns());
  EXPECT_TRUE(read_body(turned, {}, "particle", name).pivot);
  refuses(turned + "damping = { mass = 1 }\n", "brake the turn", {}, "fem", name);
  refuses(turned + "material = { model = \"linear\" }\n", "takes a turn for strain", {}, "fem", name);
  refuses(turned + "free = { x = true }\n", "free in no direction", {}, "fem", name);
  refuses(turned, "move and do not turn", {}, "ccx", name);
}

TEST(BodyKeys, AnElasticBodyStartsWithTheVelocityOfAFile) {
  const TemporaryFolder folder;
  const std::string name = (folder / "case.toml").string(),
                    plate = "plate = { length = 0.4, thickness = 0.02 }\n",
                    start = "initial_velocity = { value = [1, 0], file = \"motion.csv\" }\n";
  put(folder / "motion.csv", "x [m],vy [m/s]\n-0.2,4\n0,0\n0.2,4\n");
  const Parameters p = read_body(plate + start, {}, "fem", name);
  EXPECT_LT((velocity_at_start(p.initial, 0, {0.1, 0, 0}) - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  refuses(plate + start, "structure.velocity", {}, "rigid", name);
  for (const char* wrong :
       {"x [m],vy [m]\n0,1\n1,1\n", "x [m]\n0\n1\n", "x [m],y [m],vy [m/s]\n0,0,1\n1,1,1\n",
        "x [m],vy [m/s]\n0,1\n0,2\n", "x [m],vy [m/s]\n0,1\n"}) {
    put(folder / "motion.csv", wrong);
    refuses(plate + start, "a first line like", {}, "fem", name);
  }
}

TEST(BodyKeys, AMotionTableMustFitTheRunAndTheOtherKeys) {
  const TemporaryFolder folder;
  const std::string name = (folder / "case.toml").string(),
                    wedge = "wedge = { deadrise = 30, width = 0.5 }\nmotion = { file = \"motion.csv\" }\n";
  put(folder / "motion.csv", "t [s],y [m],angle [deg]\n0,0,0\n0.25,-1,10\n0.5,-3,20\n");
  const Parameters p = read_body(wedge, {}, "rigid", name);
  ASSERT_TRUE(p.motion);
  EXPECT_NEAR(p.motion->at(0.25).displacement.y(), -1, 1e-15);
  refuses(wedge + "free = { y = true }\n", "prescribes this motion", {}, "rigid", name);
  refuses(wedge + "free = { angle = true }\n", "prescribes this motion", {}, "rigid", name);
  refuses(wedge + "velocity = [0, -1]\n", "prescribes this motion", {}, "rigid", name);
  refuses(wedge, "end_time = 0.5", {"end_time=0.6"}, "rigid", name);
  put(folder / "motion.csv", "t [s],angel [deg]\n0,0\n1,1\n");
  refuses(wedge, "did you mean angle", {}, "rigid", name);
  refuses("wedge = { deadrise = 30, width = 0.5 }\nmotion = { file = \"none.csv\" }\n", "none.csv", {},
          "rigid", name);
}

}  // namespace solid_keys_test
}  // namespace strake::structure
