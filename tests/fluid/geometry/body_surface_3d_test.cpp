#include "fluid/geometry/body_surface_3d.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "proto/error.hpp"
#include "tests/fluid/solid_case.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace strake::fluid {
namespace {

using Eigen::Vector3d;

constexpr double l0 = 0.01, reach = 3.1 * l0;

Hull box_hull(double spacing_of_triangles = l0) {
  return Hull(box_surface({0, 0, 0}, {0.2, 0.06, 0.1}, spacing_of_triangles), l0, reach);
}
Hull sphere_hull(double radius) {
  return Hull(structure::sphere_surface({0, 0, 0}, radius, l0), l0, reach);
}

double total_area(const Hull& hull) {
  double area = 0;
  for (int k = 0; k < hull.points(); ++k) area += hull.area(k);
  return area;
}
Vector3d sum_of_areas(const Hull& hull) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < hull.points(); ++k) sum += hull.area_vector(k);
  return sum;
}

TEST(Hull, WetPointsOfABoxStandInTheMiddleOfEvenSquares) {
  for (const double triangles : {l0, 0.73 * l0, 5 * l0}) {
    const Hull hull = box_hull(triangles);
    ASSERT_EQ(hull.points(), 2 * (20 * 6 + 20 * 10 + 6 * 10));
    for (int k = 0; k < hull.points(); ++k) {
      EXPECT_NEAR(hull.area(k), l0 * l0, 1e-12);
      EXPECT_NEAR(hull.normal(k).cwiseAbs().maxCoeff(), 1, 1e-12);
      EXPECT_NEAR(hull.area_vector(k).dot(hull.normal(k)), l0 * l0, 1e-12);
      for (int d = 0; d < 3; ++d) {
        if (std::abs(hull.normal(k)[d]) > 0.5) continue;
        const double cell = hull.point(k)[d] / l0 - 0.5;
        EXPECT_NEAR(cell, std::round(cell), 1e-9);
      }
    }
    EXPECT_LT(sum_of_areas(hull).norm(), 1e-15);
  }
}

TEST(Hull, WetPointsOfASphereAreEvenAndTheirAreasClose) {
  const double radius = 0.08;
  const Hull hull = sphere_hull(radius);
  const double sphere = 4 * std::numbers::pi * radius * radius;
  EXPECT_NEAR(hull.points(), sphere / (l0 * l0), 0.01 * sphere / (l0 * l0));
  EXPECT_NEAR(total_area(hull), sphere, 0.01 * sphere);
  EXPECT_LT(sum_of_areas(hull).norm(), 1e-12 * sphere);
  for (int k = 0; k < hull.points(); ++k) {
    EXPECT_EQ(hull.run_of(k), 0);
    EXPECT_GT(hull.normal(k).dot(hull.point(k).normalized()), 0.998);
    double nearest = 1;
    for (int j = 0; j < hull.points(); ++j)
      if (j != k) nearest = std::min(nearest, (hull.point(j) - hull.point(k)).norm());
    EXPECT_GT(nearest, 0.75 * l0);
    EXPECT_LT(nearest, 1.2 * l0);
  }
}

TEST(Hull, FollowsATranslationAndARotationExactly) {
  Hull hull = box_hull();
  const Hull still = hull;
  const Eigen::AngleAxisd turn(0.4, Vector3d(1, 2, -1).normalized());
  const Vector3d spin = 5 * turn.axis(), way(0.1, -0.2, 0.3), speed(1, -6, 2);
  const Points X = hull.mesh().position;
  const Points x = (turn.toRotationMatrix() * X).colwise() + way;
  Points velocity(3, X.cols());
  for (Eigen::Index k = 0; k < X.cols(); ++k) velocity.col(k) = speed + spin.cross(Vector3d(x.col(k)) - way);
  hull.move(x - X, velocity, true);
  const auto moved = [&](const Vector3d& place) { return Vector3d(turn * place + way); };
  for (int k = 0; k < hull.points(); ++k) {
    EXPECT_LT((hull.point(k) - moved(still.point(k))).norm(), 1e-12);
    EXPECT_LT((hull.normal(k) - turn * still.normal(k)).norm(), 1e-12);
    EXPECT_LT((hull.normal_rate(k) - spin.cross(hull.normal(k))).norm(), 1e-10);
    EXPECT_LT((hull.velocity(k) - speed - spin.cross(hull.point(k) - way)).norm(), 1e-11);
  }
  for (const Hull::Row& row : hull.rows()) {
    EXPECT_LT((hull.place(row) - moved(still.place(row))).norm(), 1e-12);
    EXPECT_LT((hull.velocity(row) - speed - spin.cross(hull.place(row) - way)).norm(), 1e-11);
  }
  EXPECT_TRUE(hull.inside(moved({0.099, 0.001, 0.049})));
  EXPECT_FALSE(hull.inside(moved({0.101, 0.001, 0.049})));
}

TEST(Hull, TellsInsideFromOutsideAndTheNearestPlace) {
  const Hull box = box_hull(), sphere = sphere_hull(0.08);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> at(-0.13, 0.13);
  for (int k = 0; k < 5000; ++k) {
    const Vector3d x(at(generator), at(generator), at(generator));
    EXPECT_EQ(box.inside(x), std::abs(x.x()) < 0.1 && x.y() > 0 && x.y() < 0.06 && std::abs(x.z()) < 0.05);
    const bool clear = std::abs(x.norm() - 0.08) > 0.001;
    EXPECT_TRUE(!clear || sphere.inside(x) == (x.norm() < 0.08));
    EXPECT_NEAR(sphere.nearest(x).distance, std::abs(x.norm() - 0.08), 0.001);
  }
}

// A place in the body is seen through exactly one face, its edges included.
TEST(Hull, APlaceInsideIsSeenThroughExactlyOneFace) {
  const Hull hull = box_hull();
  std::vector<int> of_patch(6, -1);  // a wet point in the middle of each face, and near each of its edges
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> across(-2.5 * l0, 2.5 * l0);
  int seen = 0;
  for (int k = 0; k < 40000; ++k) {
    // Around the edge x = 0.1, y = 0 and, for every third, the corner with z = 0.05.
    const Vector3d corner(0.1, 0, k % 3 == 0 ? 0.05 : 0.0123);
    const Vector3d from = corner + Vector3d(across(generator), across(generator), across(generator)),
                   to = corner + Vector3d(across(generator), across(generator), across(generator));
    if (hull.inside(from) || !hull.inside(to) || (from - to).norm() > reach) continue;
    const int near = hull.near(from, reach).triangle;
    std::fill(of_patch.begin(), of_patch.end(), -1);
    std::vector<double> best(6, 1);
    for (int p = 0; p < hull.points(); ++p) {
      const auto run = static_cast<std::size_t>(hull.run_of(p));
      const double distance = (hull.point(p) - to).norm();
      if (distance >= best[run]) continue;
      best[run] = distance;
      of_patch[run] = p;
    }
    int faces = 0;
    for (const int p : of_patch)
      if (p >= 0 && (hull.point(p) - to).norm() < reach) faces += hull.crosses(p, near, from, to) ? 1 : 0;
    ASSERT_EQ(faces, 1) << from.transpose() << " to " << to.transpose();
    ++seen;
  }
  EXPECT_GT(seen, 2000);
}

// The places behind blunt edges are filled: no water sees a hole in a wedge of 30 degrees.
TEST(Hull, RowsGoOnBeyondBluntEdges) {
  const auto corner =
      structure::wedge_polygon({.deadrise = std::numbers::pi / 6, .width = 0.2, .height = 0.12});
  const Hull hull(structure::prism_surface(structure::outline(corner, l0), 0.1, 0, l0), l0, reach);
  int beyond = 0;
  for (const Hull::Row& row : hull.rows()) {
    if (row.weight.minCoeff() > -1e-6) continue;
    ++beyond;
    const double along = std::abs(hull.place(row).z());
    EXPECT_LT(along, 0.05);
    EXPECT_TRUE(hull.inside(hull.place(row))) << hull.place(row).transpose();
  }
  // tan(30 degrees): at each of ten places along apex and chines two, seen through either face.
  EXPECT_EQ(beyond, 3 * 2 * 10 * 2);
}

TEST(Hull, LoadsOnWetPointsKeepForceAndMomentOnTheMesh) {
  const Hull hull = sphere_hull(0.05);
  const Points load = Points::Random(3, hull.points());
  const Points nodes = hull.spread(load);
  Vector3d force = Vector3d::Zero(), moment = force, there = force;
  for (int k = 0; k < hull.points(); ++k) moment += hull.point(k).cross(Vector3d(load.col(k)));
  for (Eigen::Index k = 0; k < nodes.cols(); ++k)
    there += Vector3d(hull.mesh().position.col(k)).cross(Vector3d(nodes.col(k)));
  force = load.rowwise().sum() - nodes.rowwise().sum();
  EXPECT_LT(force.norm(), 1e-12);
  EXPECT_LT((moment - there).norm(), 1e-12);
}

TEST(Hull, OpenAndInvertedSurfacesAreRefused) {
  InterfaceMesh mesh = box_surface({0, 0, 0}, {0.2, 0.06, 0.1}, l0);
  InterfaceMesh open = mesh;
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  EXPECT_THROW(Hull(open, l0, reach), Error);
  mesh.faces.row(0).swap(mesh.faces.row(1));
  EXPECT_THROW(Hull(mesh, l0, reach), Error);
}

}  // namespace
}  // namespace strake::fluid
