#include "structure/participant.hpp"

#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/particle/solver.hpp"
#include "structure/replay/replay.hpp"
#include "structure/rigid/rigid.hpp"
#include "tests/structure/paper_plate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace strake::structure {
namespace participant_test {

CommonKeys mid_probe(const std::string& quantity = "deflection") {
  CommonKeys common;
  ProbeKeys probe;
  probe.name = "mid";
  probe.of = "structure";
  probe.quantity = quantity;
  common.probes = {probe};
  return common;
}

Parameters driven_plate() {
  Parameters p = paper_plate(2);
  p.velocity = {0, -6.26, 0};
  return p;
}

StructureParticipant particles(const Parameters& p, const Setup& setup = {}) {
  return {std::make_unique<ParticleSolver<2>>(p), p, mid_probe(), setup};
}

Input push(const InterfaceMesh& mesh, double size) {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, mesh.position.cols());
  force.row(1).setConstant(size);
  return {{{0, {{"force", "N", true, force}}}}};
}

TEST(StructureParticipant, SaysItsMotionAtTheStartAndItsColumns) {
  const StructureParticipant plate = particles(driven_plate());
  ASSERT_EQ(plate.description().initial.size(), 2u);
  EXPECT_EQ(find(plate.description().initial, "displacement")->value.norm(), 0);
  EXPECT_NEAR(find(plate.description().initial, "velocity")->value(1, 5), -6.26, 1e-12);
  EXPECT_EQ(plate.description().columns.at(1).name, "mid.y");
  EXPECT_EQ(plate.description().columns.at(1).unit, "m");
}

TEST(StructureParticipant, DeflectionIsTheDisplacementLessThatOfTheSupports) {
  const Parameters p = driven_plate();
  StructureParticipant deflection(std::make_unique<Rigid>(p), p, mid_probe("deflection"), {});
  StructureParticipant displacement(std::make_unique<Rigid>(p), p, mid_probe("displacement"), {});
  StructureParticipant velocity(std::make_unique<Rigid>(p), p, mid_probe("velocity"), {});
  const Window window{0.001, 1e-5};
  EXPECT_NEAR(deflection.advance(window, {}).monitor.at("mid.y"), 0, 1e-17);  // round-off of V t
  EXPECT_NEAR(displacement.advance(window, {}).monitor.at("mid.y"), -6.26 * 0.00101, 1e-15);
  EXPECT_EQ(velocity.advance(window, {}).monitor.at("mid.y"), -6.26);
}

TEST(StructureParticipant, ARigidBodyDrivenByATableHasNoDeflection) {
  constexpr MotionColumn rate = MotionColumn::rate, absent = MotionColumn::absent;
  Parameters p = driven_plate();
  p.velocity.setZero();
  p.motion = MotionTable({0, 1}, {absent, rate, absent, absent}, {{{}, {-3, -3}, {}, {}}});
  const Window window{0, 0.01};
  StructureParticipant driven(std::make_unique<Rigid>(p), p, mid_probe("deflection"), {});
  EXPECT_EQ(driven.advance(window, {}).monitor.at("mid.y"), 0);
  StructureParticipant displacement(std::make_unique<Rigid>(p), p, mid_probe("displacement"), {});
  EXPECT_NEAR(displacement.advance(window, {}).monitor.at("mid.y"), -0.03, 1e-15);
}

TEST(StructureParticipant, ProbesOfStressAreLeftOutWhereThereIsNone) {
  Parameters p = driven_plate();
  p.kind = "rigid";
  for (const char* quantity : {"stress", "von_mises"}) {
    StructureParticipant plate(std::make_unique<Rigid>(p), p, mid_probe(quantity), {});
    for (const Column& column : plate.description().columns) EXPECT_NE(column.name.substr(0, 3), "mid");
    EXPECT_EQ(plate.description().lines.back(),
              "left out: output.probe mid: rigid structures have no stress");
    EXPECT_EQ(plate.advance({0, 1e-5}, {}).monitor.count("mid"), 0u);
  }
  const StructureParticipant elastic(std::make_unique<ParticleSolver<2>>(p), p, mid_probe("von_mises"), {});
  EXPECT_EQ(elastic.description().columns.at(0).name, "mid");
}

TEST(StructureParticipant, RewindIsBitExactForMotionProbesAndEnergies) {
  StructureParticipant plate = particles(driven_plate());
  const Input load = push(plate.mesh(), 1e4), other = push(plate.mesh(), -7e4);
  plate.advance({0, 1e-5}, load);
  plate.commit(false);
  const Advanced first = plate.advance({1e-5, 1e-5}, load);
  plate.rewind();
  plate.advance({1e-5, 1e-5}, other);
  plate.rewind();
  Advanced again = plate.advance({1e-5, 1e-5}, load);
  EXPECT_EQ(first.output.at(0).value, again.output.at(0).value);
  EXPECT_EQ(first.output.at(1).value, again.output.at(1).value);
  for (const auto& [name, value] : first.monitor) {
    if (name == "seconds.step" || name == "memory.peak" || name == "count.steps")
      continue;  // costs, not results
    EXPECT_EQ(again.monitor.at(name), value) << name;
  }
}

TEST(StructureParticipant, CheckpointGoesOnBitEqualAndFramesAreWritten) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "structure_participant_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "frames");
  strake::Setup setup;
  setup.run_folder = folder;
  StructureParticipant first = particles(driven_plate(), setup), second = particles(driven_plate());
  const Input load = push(first.mesh(), 1e4);
  first.advance({0, 1e-5}, load);
  first.commit(true);
  EXPECT_TRUE(std::filesystem::exists(folder / "structure.xdmf"));
  first.checkpoint(folder);
  second.resume(folder);
  const Advanced a = first.advance({1e-5, 1e-5}, load), b = second.advance({1e-5, 1e-5}, load);
  EXPECT_EQ(a.output.at(0).value, b.output.at(0).value);
  EXPECT_EQ(a.monitor.at("mid.y"), b.monitor.at("mid.y"));
  EXPECT_EQ(a.monitor.at("check.structure_energy_drift"), b.monitor.at("check.structure_energy_drift"));
  EXPECT_EQ(a.monitor.at("count.steps_committed"), b.monitor.at("count.steps_committed"));
  std::filesystem::remove_all(folder);
}

TEST(StructureParticipant, NotesAMassThatMovesNothing) {
  Parameters p = driven_plate();
  p.kind = "rigid";
  const auto notes = [&] {
    std::string found;
    for (const std::string& line : describe(Rigid(p), p, mid_probe()))
      if (line.starts_with("note: ")) found += line;
    return found;
  };
  EXPECT_EQ(notes(), "");
  p.body.mass = 200;
  EXPECT_EQ(notes(), "note: structure.mass moves nothing, since no direction is free (structure.free)");
  p.body.lumped_mass = 3;
  EXPECT_NE(notes().find("structure.mass, structure.lumped.mass moves nothing"), std::string::npos);
  p.free.y = true;
  EXPECT_EQ(notes(), "");
  p.free.y = false;
  p.kind = "fem";
  EXPECT_EQ(notes(), "") << "its mass is that of its material";
}

TEST(StructureParticipant, FeelsTheLoadOfItsWetFacesAlone) {
  Parameters p = paper_plate(2);
  StructureParticipant all = particles(p);
  p.loaded_faces = {"bottom"};
  StructureParticipant below = particles(p), idle = particles(p);
  const auto row = [&](double y) {  // a force on the points at one height, but for the corners
    Input input = push(below.mesh(), 0);
    for (Eigen::Index i = 0; i < below.mesh().position.cols(); ++i)
      if (std::abs(below.mesh().position(1, i) - y) < 1e-9 && std::abs(below.mesh().position(0, i)) < 0.199)
        input.samples[0].fields[0].value.edit()(1, i) = 1e4;
    return input;
  };
  const Window window{0, 1e-5};
  EXPECT_EQ(below.advance(window, row(0)).output.at(0).value, all.advance(window, row(0)).output.at(0).value);
  below.rewind();
  all.rewind();
  EXPECT_EQ(below.advance(window, row(0.02)).output.at(0).value, idle.advance(window, {}).output.at(0).value);
  EXPECT_NE(all.advance(window, row(0.02)).output.at(0).value, idle.mesh().position);
  const auto& lines = below.description().lines;
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.starts_with("wet: bottom, 0.4 m of 0.84 m");
  }));
  // A corner's load is half the bottom's.
  Input corner = push(below.mesh(), 0), half = corner;
  corner.samples[0].fields[0].value.edit()(1, 0) = 1e4;
  half.samples[0].fields[0].value.edit()(1, 0) = 5e3;
  below.rewind();
  all.rewind();
  EXPECT_NEAR(
      (below.advance(window, corner).output.at(0).value - all.advance(window, half).output.at(0).value)
          .norm(),
      0, 1e-20);
}

TEST(StructureParticipant, StaticsAndModesAreSolvedInTheFirstWindow) {
  Parameters p = paper_plate(2);
  p.load.kind = LoadKind::traction;
  p.load.value = {0, -1e5, 0};
  p.analysis = Analysis::statics;
  StructureParticipant statics(std::make_unique<ParticleSolver<2>>(p), p, mid_probe(), {});
  EXPECT_LT(statics.advance({0, 1e-3}, {}).monitor.at("mid.y"), -2e-5);
  p.analysis = Analysis::modal;
  StructureParticipant modal(std::make_unique<ParticleSolver<2>>(p), p, mid_probe(), {});
  EXPECT_EQ(modal.description().columns.back().name, "f3");
  const Advanced modes = modal.advance({0, 1e-3}, {});
  EXPECT_GT(modes.monitor.at("f1:final"), 600);
  EXPECT_GT(modes.monitor.at("f2"), modes.monitor.at("f1"));
}

TEST(StructureParticipant, FirstPeakOfAnEnteringPlateCountsFromContactAlone) {
  StructureParticipant plate = particles(driven_plate());
  const double contact = 0.5 * 1000 * 6.26 * 6.26;  // [Pa] ½ρV²
  double t = 0;
  const auto go = [&](double pressure, int windows) {
    Advanced last;
    for (int k = 0; k < windows; ++k, t += 1e-5) {
      last = plate.advance({t, 1e-5}, push(plate.mesh(), 0.01 * pressure));  // points stand 0.01 m apart
      plate.commit(false);
    }
    return last;
  };
  EXPECT_FALSE(go(0.5 * contact, 120).monitor.contains("mid.y:first_peak"));  // swings, but is not hit
  const double hit = t;
  const Advanced after = go(20 * contact, 120);
  EXPECT_EQ(after.monitor.at("mid.y:contact"), hit);
  EXPECT_GT(after.monitor.at("mid.y:time_of_first_peak"), hit);
}

TEST(StructureParticipant, ABodyFromRestIsMeasuredFromItsContactToo) {
  constexpr MotionColumn rate = MotionColumn::rate, absent = MotionColumn::absent;
  Parameters p = driven_plate();
  p.velocity.setZero();
  p.motion = MotionTable({0, 1e-4, 1}, {absent, rate, absent, absent}, {{{}, {0, -6.26, -6.26}, {}, {}}});
  CommonKeys common = mid_probe("displacement");
  const auto contact_under = [&](double pressure) {
    StructureParticipant plate(std::make_unique<Rigid>(p), p, common, {});
    Advanced last;
    for (int k = 0; k < 60; ++k) {
      last = plate.advance({k * 1e-5, 1e-5}, push(plate.mesh(), k < 40 ? 0 : 0.01 * pressure));
      plate.commit(false);
    }
    const auto found = last.monitor.find("mid.y:contact");
    return found == last.monitor.end() ? -1 : found->second;
  };
  const double speed_pressure = 0.5 * 1000 * 6.26 * 6.26;  // [Pa] ½ρV²
  EXPECT_EQ(contact_under(2 * speed_pressure), -1) << "not said to move later: it is measured from the start";
  common.chosen.from_rest = true;
  EXPECT_EQ(contact_under(2 * speed_pressure), 40 * 1e-5);
  EXPECT_EQ(contact_under(0.5 * speed_pressure), -1);
}

TEST(Replay, GivesTheRecordedMotionAndRefusesAnotherMesh) {
  const Parameters p = driven_plate();
  InterfaceRecord record;
  record.mesh = surface(p);
  const Eigen::Index n = record.mesh.position.cols();
  record.initial_displacement = Points::Zero(3, n);
  record.initial_velocity = Points::Constant(3, n, 2);
  for (int k = 0; k < 3; ++k) {
    record.windows.push_back({k * 1e-3, 1e-3});
    record.displacement.push_back(Points::Constant(3, n, 2e-3 * (k + 1)));
    record.velocity.push_back(Points::Constant(3, n, 2));
    record.force.push_back(Points::Zero(3, n));
  }
  Replay replay(p, record);
  replay.advance(0, 0.5e-3, {});  // half a recorded window: the motion between
  EXPECT_NEAR(replay.displacement()(1, 3), 1e-3, 1e-15);
  replay.advance(0.5e-3, 0.5e-3, {});
  EXPECT_EQ(replay.displacement(), record.displacement[0]);
  EXPECT_NEAR(replay.displacement_at({0, 0, 0}).y(), 2e-3, 1e-15);
  EXPECT_THROW(replay.advance(3e-3, 1e-3, {}), Error);  // beyond the record

  Parameters other = p;
  other.surface_spacing = 0.005;
  EXPECT_THROW(Replay(other, record), Error);
  other = p;
  other.plate.bottom.y() += 0.01;
  EXPECT_THROW(Replay(other, record), Error);
  other = p;
  other.end_time = 4e-3;  // the record ends at 3e-3
  EXPECT_THROW(Replay(other, record), Error);
}

TEST(Replay, GivesAPlaceInASolidBodyTheMotionOfItsNearestFace) {
  Parameters p;
  p.kind = "replay";
  p.dimension = 3;
  p.surface_spacing = 0.05;
  p.plate = {.length = 0.4, .thickness = 0.1, .bottom = {0, 0, 0}};
  p.shape.depth = 0.3;
  InterfaceRecord record;
  record.mesh = surface(p);
  const Points X = record.mesh.position;
  Points turned = Points::Zero(3, X.cols());  // linear in x, y, z
  turned.row(0) = 0.1 * X.row(1);
  turned.row(1) = -0.1 * X.row(0) + 0.2 * X.row(2);
  record.initial_displacement = record.initial_velocity = Points::Zero(3, X.cols());
  record.windows = {{0, 1e-3}};
  record.displacement = record.velocity = {turned};
  record.force = {Points::Zero(3, X.cols())};
  Replay replay(p, record);
  replay.advance(0, 1e-3, {});
  const Eigen::Vector3d at(0.033, 0, 0.017), moved(0, -0.0033 + 0.0034, 0);
  EXPECT_LT((replay.displacement_at(at) - moved).norm(), 1e-15);
}

TEST(StructureParticipant, AFreeBodyReportsItsMotionAndGoesOnFromACheckpointBitEqual) {
  Parameters p;
  p.kind = "rigid";
  p.shape.kind = ShapeKind::wedge;
  p.shape.corner = wedge_polygon({.deadrise = 0.5, .width = 0.5, .height = 0.3});
  p.surface_spacing = 0.02;
  p.free.y = p.free.angle = true;
  p.velocity = {0, -6.15, 0};
  p.gravity = {0, -9.81, 0};
  const auto body = [&] {
    return StructureParticipant(std::make_unique<Rigid>(p), p, mid_probe("velocity"), {});
  };
  StructureParticipant first = body(), second = body();
  const auto names = first.description().columns;
  const auto has = [&](const std::string& name, const std::string& unit) {
    return std::any_of(names.begin(), names.end(),
                       [&](const Column& c) { return c.name == name && c.unit == unit; });
  };
  EXPECT_TRUE(has("body.y", "m") && has("body.angle", "deg") && has("body.vy", "m/s") &&
              has("body.fy", "N") && has("body.moment", "N m") && has("energy.kinetic", "J"));
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "free_body_test";
  std::filesystem::create_directories(folder);
  first.advance({0, 1e-4}, push(first.mesh(), 3));
  first.commit(false);
  first.checkpoint(folder);
  second.resume(folder);
  const Advanced a = first.advance({1e-4, 1e-4}, push(first.mesh(), 5)),
                 b = second.advance({1e-4, 1e-4}, push(second.mesh(), 5));
  EXPECT_EQ(a.output.at(0).value, b.output.at(0).value);
  EXPECT_EQ(a.output.at(1).value, b.output.at(1).value);
  for (const char* name :
       {"body.y", "body.angle", "body.vy", "body.fy", "mid.y", "check.structure_energy_drift"})
    EXPECT_EQ(a.monitor.at(name), b.monitor.at(name)) << name;
  EXPECT_NEAR(a.monitor.at("body.fy"), 5.0 * static_cast<double>(first.mesh().position.cols()), 1e-9);
  EXPECT_LT(a.monitor.at("check.structure_energy_drift"), 1e-12);
  std::filesystem::remove_all(folder);
}

// A bar of particles under tension: one stress alone but for what the plane adds.
TEST(StructureParticipant, ProbesOfStressHaveAColumnPerComponent) {
  Parameters p = paper_plate(4);
  p.plate.right = Support::free;
  p.analysis = Analysis::statics;
  p.load = {.kind = LoadKind::traction, .value = {1e6, 0, 0}, .face = "right", .at = {}, .ramp = 0};
  CommonKeys common = mid_probe("stress");
  common.probes[0].at = {0, 0.01, 0};
  common.probes.push_back(common.probes[0]);
  common.probes[1].name = "size";
  common.probes[1].quantity = "von_mises";
  StructureParticipant participant(std::make_unique<ParticleSolver<2>>(p), p, common, {});
  const auto& columns = participant.description().columns;
  for (const char* name : {"mid.xx", "mid.xy", "mid.yy", "mid.zz", "size"})
    EXPECT_TRUE(std::any_of(columns.begin(), columns.end(), [&](const Column& c) {
      return c.name == name && c.unit == "Pa";
    })) << name;
  participant.start({0, 1e-5}, {});
  const auto monitor = participant.finish().monitor;
  EXPECT_NEAR(monitor.at("mid.xx"), 1e6, 2e4);
  EXPECT_NEAR(monitor.at("mid.yy"), 0, 2e4);
  EXPECT_NEAR(monitor.at("mid.zz"), 0.3e6, 1e4);
  const double xx = monitor.at("mid.xx"), zz = monitor.at("mid.zz");
  EXPECT_NEAR(monitor.at("size"), std::sqrt(xx * xx - xx * zz + zz * zz), 2e4);
}

}  // namespace participant_test
}  // namespace strake::structure
