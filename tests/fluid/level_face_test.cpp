#include "fluid/level_face.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake::fluid {
namespace level_face_test {

/// A closed polygon of n points, walked counter-clockwise.
InterfaceMesh polygon(const Eigen::Matrix2Xd& points) {
  InterfaceMesh mesh;
  mesh.dimension = 2;
  mesh.position = Points::Zero(3, points.cols());
  mesh.position.topRows<2>() = points;
  mesh.faces.resize(2, points.cols());
  for (int k = 0; k < points.cols(); ++k) mesh.faces.col(k) << k, (k + 1) % static_cast<int>(points.cols());
  return mesh;
}

/// A box 0.4 m wide and 0.1 m high, turned by `degrees`; its lowest point lies at y = 0.01 m.
InterfaceMesh box(double degrees) {
  Eigen::Matrix2Xd corners(2, 4);
  corners << -0.2, 0.2, 0.2, -0.2, 0, 0, 0.1, 0.1;
  const Eigen::Rotation2D<double> turn(degrees * std::numbers::pi / 180);
  corners = turn.toRotationMatrix() * corners;
  corners.row(1).array() += 0.01 - corners.row(1).minCoeff();
  return polygon(corners);
}

TEST(LevelFace, the_lower_face_of_a_box_counts_and_its_upper_one_does_not) {
  EXPECT_DOUBLE_EQ(level_face(box(0), 0), 0.4);
  EXPECT_NEAR(level_face(box(0.9), 0), 0.4, 1e-12);
  EXPECT_EQ(level_face(box(1.1), 0), 0);
  EXPECT_EQ(level_face(box(180), 0.02), 0);  // already below the level
}

TEST(LevelFace, of_a_cylinder_and_of_no_body_next_to_nothing_counts) {
  Eigen::Matrix2Xd circle(2, 360);
  for (int k = 0; k < 360; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / 360;
    circle.col(k) << 0.1 * std::cos(angle), 0.2 + 0.1 * std::sin(angle);
  }
  EXPECT_LT(level_face(polygon(circle), 0), 0.006);
  EXPECT_EQ(level_face(InterfaceMesh{}, 0), 0);
}

TEST(LevelFace, in_space_it_is_an_area) {
  InterfaceMesh mesh;
  mesh.position = Points::Zero(3, 4);
  mesh.position.row(0) << 0, 0.3, 0.3, 0;
  mesh.position.row(2) << 0, 0, 0.2, 0.2;
  mesh.faces.resize(3, 2);
  mesh.faces.col(0) << 0, 1, 2;  // (b − a) × (c − a) looks down
  mesh.faces.col(1) << 0, 2, 3;
  EXPECT_NEAR(level_face(mesh, 0), 0.06, 1e-15);
  mesh.faces.row(1).swap(mesh.faces.row(2));
  EXPECT_EQ(level_face(mesh, 0), 0);
}

}  // namespace level_face_test
}  // namespace strake::fluid
