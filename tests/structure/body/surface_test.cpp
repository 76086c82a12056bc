#include "structure/body/surface.hpp"

#include "proto/geometry/face_direction.hpp"
#include "structure/rigid/rigid.hpp"
#include "tests/structure/body/boxes.hpp"
#include "tests/structure/paper_plate.hpp"

#include <gtest/gtest.h>

namespace strake::structure {
namespace surface_test {

Solid solid_of(const Plate& plate) {
  Parameters p;
  p.plate = plate;
  return elastic_solid(p);
}

TEST(Surface, OutlineIsClosedCounterClockwiseAndHasTheCornersAsPoints) {
  Plate plate{.length = 0.4, .thickness = 0.02, .bottom = {0.1, 0.012, 0}};
  const InterfaceMesh mesh = outline(plate, 0.01);
  EXPECT_EQ(mesh.position.cols(), 2 * (40 + 2));
  EXPECT_NEAR(enclosed_volume(mesh.faces, mesh.position), 0.4 * 0.02, 1e-15);  // positive: counter-clockwise
  EXPECT_NEAR(point_sizes(mesh).sum(), 2 * 0.42, 1e-14);
  for (const double x : {-0.1, 0.3})
    for (const double y : {0.012, 0.032})
      EXPECT_LT((mesh.position.colwise() - Eigen::Vector3d(x, y, 0)).colwise().norm().minCoeff(), 1e-15);
}

TEST(Surface, NormalOfTheLowerFacePointsDownIntoTheWater) {
  const InterfaceMesh mesh = outline({.length = 0.4, .thickness = 0.02}, 0.03);  // 13 parts: not a divisor
  const Eigen::Vector3d t = mesh.position.col(mesh.faces(1, 0)) - mesh.position.col(mesh.faces(0, 0));
  EXPECT_GT(t.x(), 0);
  EXPECT_DOUBLE_EQ(t.x(), 0.4 / 13);
  EXPECT_DOUBLE_EQ(mesh.position(1, mesh.faces(0, 0)), 0);
}

TEST(Surface, TractionGivesItsResultantAndMomentOnOneFace) {
  const Plate plate{.length = 0.4, .thickness = 0.02, .bottom = {0.2, 0, 0}};
  CaseLoad load;
  load.kind = LoadKind::traction;
  load.value = {0, -1e5, 0};
  load.face = "top";
  const InterfaceMesh mesh = outline(plate, 0.007);
  const Points force = case_force(load, solid_of(plate), mesh);
  EXPECT_NEAR(force.row(1).sum(), -1e5 * 0.4, 1e-9);
  double moment = 0;
  for (Eigen::Index i = 0; i < force.cols(); ++i) moment += mesh.position(0, i) * force(1, i);
  EXPECT_NEAR(moment, -1e5 * 0.4 * 0.2, 1e-9);
}

TEST(Surface, PointForceActsOnTheNearestPoint) {
  const Plate plate{.length = 0.4, .thickness = 0.02};
  CaseLoad load;
  load.kind = LoadKind::point;
  load.value = {0, 3, 0};
  load.at = {0.199, 0.021, 0};
  const InterfaceMesh mesh = outline(plate, 0.01);
  const Points force = case_force(load, solid_of(plate), mesh);
  Eigen::Index loaded = -1;
  EXPECT_EQ(force.row(1).maxCoeff(&loaded), 3);
  EXPECT_LT((mesh.position.col(loaded) - Eigen::Vector3d(0.2, 0.02, 0)).norm(), 1e-12);
}

// A traction on the warped side of a body acts on all of it, and such a side may be all that the water loads.
TEST(Surface, ATractionActsOnAWarpedSide) {
  Parameters p;
  p.dimension = 3;
  p.kind = "rigid";
  p.shape.kind = ShapeKind::solid;
  p.solid = warped_bar(0.01);
  const InterfaceMesh mesh = surface(p);
  const Points force =
      case_force({.kind = LoadKind::traction, .value = {0, -100, 0}, .face = "deck"}, p.solid, mesh);
  EXPECT_NEAR(force.row(1).sum() / -20, 1, 0.01) << "0.2 m² and what the twist adds";
  p.loaded_faces = {"deck"};
  EXPECT_NEAR(loaded_faces(p, mesh).size, 0.2, 0.002);
}

TEST(Surface, RampRisesFromZeroToOneAndIsOneWithoutLength) {
  EXPECT_EQ(ramp_factor(0, 0), 1);
  EXPECT_EQ(ramp_factor(0, 0.1), 0);
  EXPECT_NEAR(ramp_factor(0.05, 0.1), 0.5, 1e-15);
  EXPECT_EQ(ramp_factor(0.2, 0.1), 1);
}

TEST(Load, OneSampleIsHeldAndAHistoryIsLinearBetweenItsSamples) {
  const auto sample = [](double time, double value) {
    return Sample{time, {{"force", "N", true, Eigen::MatrixXd::Constant(3, 2, value)}}};
  };
  EXPECT_EQ(Load().at(1, 2), Points::Zero(3, 2));
  EXPECT_EQ(Load({sample(1, 5)}).at(0.3, 2), Points::Constant(3, 2, 5));
  const Load history({sample(1, 2), sample(2, 6)});
  EXPECT_EQ(history.at(1.25, 2), Points::Constant(3, 2, 3));
  EXPECT_EQ(history.at(0, 2), Points::Constant(3, 2, 2));
  EXPECT_EQ(history.at(9, 2), Points::Constant(3, 2, 6));
}

TEST(Rigid, MovesExactlyWithItsVelocityAndRewindsToTheBit) {
  Parameters p = paper_plate(4);
  p.velocity = {0, -6.26, 0};
  Rigid plate(p);
  EXPECT_EQ(plate.velocity().col(3), p.velocity);
  plate.save();
  plate.advance(0.001, 1e-5, {});
  EXPECT_EQ(plate.displacement().col(7), p.velocity * (0.001 + 1e-5));
  plate.restore();
  EXPECT_EQ(plate.displacement().norm(), 0);
  EXPECT_NEAR(plate.energy().kinetic, 0.5 * 62.4 * 6.26 * 6.26, 1e-9);
}

}  // namespace surface_test
}  // namespace strake::structure
