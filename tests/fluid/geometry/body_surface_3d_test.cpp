#include "fluid/geometry/body_surface_3d.hpp"

#include "fluid/boundary/boundary.hpp"
#include "fluid/boundary/fill.hpp"
#include "fluid/scheme/step_data.hpp"
#include "proto/error.hpp"
#include "tests/fluid/solid_case.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>
#include <vector>

namespace strake::fluid {
namespace body_surface_3d_test {

using Eigen::Vector3d;

constexpr double l0 = 0.01, reach = 3.1 * l0;

BodySurface3d box_body(double spacing_of_triangles = l0) {
  return BodySurface3d(box_surface({0, 0, 0}, {0.2, 0.06, 0.1}, spacing_of_triangles), l0, reach);
}
BodySurface3d sphere_body(double radius) {
  return BodySurface3d(structure::sphere_surface({0, 0, 0}, radius, l0), l0, reach);
}

double total_area(const BodySurface3d& body) {
  double area = 0;
  for (int k = 0; k < body.points(); ++k) area += body.area(k);
  return area;
}
Vector3d sum_of_areas(const BodySurface3d& body) {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < body.points(); ++k) sum += body.area_vector(k);
  return sum;
}

TEST(BodySurface3d, WetPointsOfABoxStandInTheMiddleOfEvenSquares) {
  for (const double triangles : {l0, 0.73 * l0, 5 * l0}) {
    const BodySurface3d body = box_body(triangles);
    ASSERT_EQ(body.points(), 2 * (20 * 6 + 20 * 10 + 6 * 10));
    for (int k = 0; k < body.points(); ++k) {
      EXPECT_NEAR(body.area(k), l0 * l0, 1e-12);
      EXPECT_NEAR(body.normal(k).cwiseAbs().maxCoeff(), 1, 1e-12);
      EXPECT_NEAR(body.area_vector(k).dot(body.normal(k)), l0 * l0, 1e-12);
      for (int d = 0; d < 3; ++d) {
        if (std::abs(body.normal(k)[d]) > 0.5) continue;
        const double cell = body.point(k)[d] / l0 - 0.5;
        EXPECT_NEAR(cell, std::round(cell), 1e-9);
      }
    }
    EXPECT_LT(sum_of_areas(body).norm(), 1e-15);
  }
}

TEST(BodySurface3d, WetPointsOfASphereAreEvenAndTheirAreasClose) {
  const double radius = 0.08;
  const BodySurface3d body = sphere_body(radius);
  const double sphere = 4 * std::numbers::pi * radius * radius;
  EXPECT_NEAR(body.points(), sphere / (l0 * l0), 0.01 * sphere / (l0 * l0));
  EXPECT_NEAR(total_area(body), sphere, 0.01 * sphere);
  EXPECT_LT(sum_of_areas(body).norm(), 1e-12 * sphere);
  for (int k = 0; k < body.points(); ++k) {
    EXPECT_EQ(body.edge_of(k), 0);
    EXPECT_GT(body.normal(k).dot(body.point(k).normalized()), 0.998);
    double nearest = 1;
    for (int j = 0; j < body.points(); ++j)
      if (j != k) nearest = std::min(nearest, (body.point(j) - body.point(k)).norm());
    EXPECT_GT(nearest, 0.75 * l0);
    EXPECT_LT(nearest, 1.2 * l0);
  }
}

TEST(BodySurface3d, FollowsATranslationAndARotationExactly) {
  BodySurface3d body = box_body();
  const BodySurface3d still = body;
  const Eigen::AngleAxisd turn(0.4, Vector3d(1, 2, -1).normalized());
  const Vector3d spin = 5 * turn.axis(), way(0.1, -0.2, 0.3), speed(1, -6, 2);
  const Points X = body.mesh().position;
  const Points x = (turn.toRotationMatrix() * X).colwise() + way;
  Points velocity(3, X.cols());
  for (Eigen::Index k = 0; k < X.cols(); ++k) velocity.col(k) = speed + spin.cross(Vector3d(x.col(k)) - way);
  body.move(x - X, velocity, true);
  const auto moved = [&](const Vector3d& place) { return Vector3d(turn * place + way); };
  for (int k = 0; k < body.points(); ++k) {
    EXPECT_LT((body.point(k) - moved(still.point(k))).norm(), 1e-12);
    EXPECT_LT((body.normal(k) - turn * still.normal(k)).norm(), 1e-12);
    EXPECT_LT((body.normal_rate(k) - spin.cross(body.normal(k))).norm(), 1e-10);
    EXPECT_LT((body.velocity(k) - speed - spin.cross(body.point(k) - way)).norm(), 1e-11);
  }
  for (const BodySurface3d::LayerParticle& row : body.layer_particles()) {
    EXPECT_LT((body.place(row) - moved(still.place(row))).norm(), 1e-12);
    EXPECT_LT((body.velocity(row) - speed - spin.cross(body.place(row) - way)).norm(), 1e-11);
  }
  EXPECT_TRUE(body.inside(moved({0.099, 0.001, 0.049})));
  EXPECT_FALSE(body.inside(moved({0.101, 0.001, 0.049})));
}

TEST(BodySurface3d, TellsInsideFromOutsideAndTheNearestPlace) {
  const BodySurface3d box = box_body(), sphere = sphere_body(0.08);
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
TEST(BodySurface3d, APlaceInsideIsSeenThroughExactlyOneFace) {
  const BodySurface3d body = box_body();
  std::vector<int> of_patch(6, -1);  // a wet point in the middle of each face, and near each of its edges
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> across(-2.5 * l0, 2.5 * l0);
  int seen = 0;
  for (int k = 0; k < 40000; ++k) {
    // Around the edge x = 0.1, y = 0 and, for every third, the corner with z = 0.05.
    const Vector3d corner(0.1, 0, k % 3 == 0 ? 0.05 : 0.0123);
    const Vector3d from = corner + Vector3d(across(generator), across(generator), across(generator)),
                   to = corner + Vector3d(across(generator), across(generator), across(generator));
    if (body.inside(from) || !body.inside(to) || (from - to).norm() > reach) continue;
    const int near = body.near(from, reach).triangle;
    std::fill(of_patch.begin(), of_patch.end(), -1);
    std::vector<double> best(6, 1);
    for (int p = 0; p < body.points(); ++p) {
      const auto run = static_cast<std::size_t>(body.edge_of(p));
      const double distance = (body.point(p) - to).norm();
      if (distance >= best[run]) continue;
      best[run] = distance;
      of_patch[run] = p;
    }
    int faces = 0;
    for (const int p : of_patch)
      if (p >= 0 && (body.point(p) - to).norm() < reach) faces += body.crosses(p, near, from, to) ? 1 : 0;
    ASSERT_EQ(faces, 1) << from.transpose() << " to " << to.transpose();
    ++seen;
  }
  EXPECT_GT(seen, 2000);
}

// The places behind blunt edges are filled: no water sees a hole in a wedge of 30 degrees.
TEST(BodySurface3d, RowsGoOnBeyondBluntEdges) {
  const auto corner =
      structure::wedge_polygon({.deadrise = std::numbers::pi / 6, .width = 0.2, .height = 0.12});
  const BodySurface3d body(structure::prism_surface(structure::outline(corner, l0), 0.1, 0, l0), l0, reach);
  int beyond = 0;
  for (const BodySurface3d::LayerParticle& row : body.layer_particles()) {
    if (row.weight.minCoeff() > -1e-6) continue;
    ++beyond;
    const double along = std::abs(body.place(row).z());
    EXPECT_LT(along, 0.05);
    EXPECT_TRUE(body.inside(body.place(row))) << body.place(row).transpose();
  }
  // tan(30 degrees): at each of ten places along apex and chines two, seen through either face.
  EXPECT_EQ(beyond, 3 * 2 * 10 * 2);
}

// A wet point of the patch with that normal, the nearest to x.
int wet_point(const BodySurface3d& body, const Vector3d& normal, const Vector3d& x) {
  int nearest = -1;
  for (int k = 0; k < body.points(); ++k)
    if (body.normal(k).dot(normal) > 0.999 &&
        (nearest < 0 || (body.point(k) - x).norm() < (body.point(nearest) - x).norm()))
      nearest = k;
  return nearest;
}

TEST(BodySurface3d, HowFarAPlaceLiesInsideAFaceIsCountedFromItsNearestEdge) {
  const Eigen::AngleAxisd turn(0.4, Vector3d(1, 2, -1).normalized());
  const Vector3d way(0.1, -0.2, 0.3);
  BodySurface3d body = box_body();
  const Points X = body.mesh().position, x = (turn.toRotationMatrix() * X).colwise() + way;
  body.move(x - X, Points::Zero(3, X.cols()), true);
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> beside(-2 * l0, 2 * l0), along(-0.03, 0.07), below(-2 * l0, 0);
  for (int n = 0; n < 2000;
       ++n) {  // under the lower face, near its edge x = 0.1 and the corner with z = 0.05
    const Vector3d place(0.1 + beside(generator), below(generator), along(generator)),
        at = turn * place + way;
    const int k = wet_point(body, turn * Vector3d(0, -1, 0), at);
    const double in_x = 0.1 - place.x(), in_z = 0.05 - place.z();
    const double inside =
        in_x >= 0 && in_z >= 0 ? std::min(in_x, in_z) : -std::hypot(std::min(in_x, 0.0), std::min(in_z, 0.0));
    EXPECT_NEAR(body.within(k, at), inside, 1e-12) << place.transpose();
    EXPECT_EQ(body.within(k, at) >= 0, body.faces(k, at)) << place.transpose();
  }
}

std::vector<Eigen::Vector2d> wedge_of(double degrees) {
  return structure::wedge_polygon(
      {.deadrise = degrees * std::numbers::pi / 180, .width = 0.08, .height = 0.26});
}

BodySurface3d prism(const std::vector<Eigen::Vector2d>& corner) {
  return BodySurface3d(structure::prism_surface(structure::outline(corner, l0), 0.1, 0, l0), l0, reach);
}

// Wedges with their keels along z. Places under the keel, turned by less than the deadrise from the vertical,
// lie past both faces. Steeper than 75 degrees the faces of a keel hardly look down.
TEST(BodySurface3d, APlaceBeforeABluntEdgeOrAKeelLiesOverOneFace) {
  for (const double deadrise : {30.0, 45.0, 60.0, 72.0, 78.0}) {
    const BodySurface3d wedge = prism(wedge_of(deadrise));
    const double angle = deadrise * std::numbers::pi / 180;
    const Vector3d right(std::sin(angle), -std::cos(angle), 0), left(-right.x(), right.y(), 0);
    const bool sharp = deadrise > 75;
    for (const double z : {-0.04, 0.0, 0.031})
      for (const double turn : {-0.5, -0.2, -0.01, 0.01, 0.2, 0.5}) {
        const Vector3d keel(0, 0, z), place = keel + 0.4 * l0 * Vector3d(std::sin(turn), -std::cos(turn), 0);
        EXPECT_EQ(wedge.faces(wet_point(wedge, right, keel), place), !sharp && turn > 0)
            << deadrise << ' ' << z << ' ' << turn;
        EXPECT_EQ(wedge.faces(wet_point(wedge, left, keel), place), !sharp && turn < 0)
            << deadrise << ' ' << z << ' ' << turn;
      }
    // Past the sharp edges of the ends no face begins.
    EXPECT_FALSE(wedge.faces(wet_point(wedge, right, {0, 0, 0.05}), {0.001, -0.4 * l0, 0.05 + 0.1 * l0}));
  }
}

// Whether the nearest edge of the face with that normal is sharp, seen from x over that face.
bool is_sharp_beside(const BodySurface3d& body, const Vector3d& normal, const Vector3d& x) {
  double nearest = std::numeric_limits<double>::infinity();
  bool sharp = false;
  body.within(wet_point(body, normal, x), x, [&](bool is_sharp, const Vector3d& place) {
    if ((place - x).norm() >= nearest) return false;
    nearest = (place - x).norm();
    sharp = is_sharp;
    return true;
  });
  return sharp;
}

// Wedges upright and heeled, swept along z: the plane and space agree where water leaves them.
TEST(BodySurface3d, EdgesOfAPrismAreSharpWhereTheCornersOfItsSectionAre) {
  int keels = 0;
  for (const double deadrise : {45.0, 60.0, 78.0})
    for (const double heel : {0.0, 20.0}) {
      std::vector<Eigen::Vector2d> corner = wedge_of(deadrise);
      for (auto& x : corner) x = Eigen::Rotation2Dd(heel * std::numbers::pi / 180) * x;
      const BodySurface2d section(structure::outline(corner, l0), l0);
      const BodySurface3d body = prism(corner);
      for (int e = 0; e < static_cast<int>(section.edges().size()); ++e) {
        const BodySurface2d::Edge& edge = section.edges()[static_cast<std::size_t>(e)];
        for (const bool last : {false, true}) {
          const int vertex = edge.vertex + (last ? edge.count : 0),
                    point = edge.first + (last ? edge.count - 1 : 0);
          const bool sharp = last ? edge.end_sharp : edge.start_sharp;
          const Eigen::Vector2d at = section.vertex(vertex), middle = section.point(point),
                                n = section.normal(point);
          const Vector3d normal(n.x(), n.y(), 0);
          const Eigen::Vector2d x = at + 0.3 * l0 * ((middle - at).normalized() + n);
          EXPECT_EQ(is_sharp_beside(body, normal, {x.x(), x.y(), 0}), sharp)
              << deadrise << ' ' << heel << ' ' << at.transpose();
          keels +=
              !sharp && (last ? edge.end_angle : edge.start_angle) < 0.5 * std::numbers::pi + 1e-6 ? 1 : 0;
          EXPECT_EQ(body.is_between_sharp_corners(wet_point(body, normal, {middle.x(), middle.y(), 0})),
                    section.is_between_sharp_corners(e))
              << deadrise << ' ' << heel << ' ' << middle.transpose();
        }
      }
    }
  EXPECT_EQ(keels, 6);  // two sides each: 45 degrees, 45 heeled, 60
}

TEST(BodySurface3d, TheWayAroundAKeelGrowsFromTheStraightOne) {
  for (const double deadrise : {30.0, 45.0, 60.0}) {
    const BodySurface3d wedge = prism(wedge_of(deadrise));
    const double open = 0.7 * l0 * std::tan(deadrise * std::numbers::pi / 180);  // water ends there
    for (const double up : {-0.3 * l0, 1e-9, 0.1 * l0, 0.9 * open}) {
      const Vector3d a(-0.7 * l0, up, 0.01), b(0.7 * l0, up, 0.018);
      const int near_a = wedge.near(a, reach).triangle, near_b = wedge.near(b, reach).triangle;
      EXPECT_EQ(wedge.separates(a, near_a, b, near_b), up > 0) << deadrise << ' ' << up;
      if (up < 0) continue;
      const double way = std::hypot(2 * std::hypot(0.7 * l0, up), 0.8 * l0);  // unfolded about the keel
      EXPECT_NEAR(wedge.way_around(a, near_a, b, near_b), way, 1e-12) << deadrise << ' ' << up;
    }
    EXPECT_TRUE(wedge.beside_corner({-0.7 * l0, 0, 0.01}, 0.8 * l0));
    EXPECT_FALSE(wedge.beside_corner({-0.7 * l0, 0, 0.01}, 0.6 * l0));
  }
  // Around an edge of a box there is no way, however short.
  const BodySurface3d box = box_body();
  const Vector3d below(0.099, -0.001, 0), beside(0.101, 0.001, 0);
  const int near_below = box.near(below, reach).triangle, near_beside = box.near(beside, reach).triangle;
  EXPECT_EQ(box.way_around(below, near_below, beside, near_beside), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(box.beside_corner(below, reach));
}

/// Returns the length of a pair of water 0.9 l0 aside of a keel, 0.3 l0 over it; infinite where there is
/// none. The keel is `length` long, the water at z and other_z.
double length_across_keel(Parameters p, double length, double z, double other_z) {
  p.scheme = {};
  p.scheme.gradient = Gradient::least_squares;
  const InterfaceMesh body = structure::prism_surface(structure::outline(wedge_of(45), l0), length, 0, l0);
  Points up = Points::Zero(3, body.position.cols());
  InterfaceMesh above = body;
  above.position.row(1).array() += 0.3 * l0;
  StepData<3> step(p, above, up, PairData::inverses, {});
  up.row(1).setConstant(-0.8 * l0);  // the keel is 0.5 l0 under the level
  step.boundary.move(step.state, up, Points::Zero(3, up.cols()), true);
  step.state.position.col(0) << -0.9 * l0, -0.2 * l0, z;
  step.state.position.col(1) << 0.9 * l0, -0.2 * l0, other_z;
  step.search_neighbours();
  const auto row = step.far->row(0);
  const auto pair = std::find(row.begin(), row.end(), 1) - row.begin();
  return pair < std::ssize(row) ? step.far->distances(0)[static_cast<std::size_t>(pair)]
                                : std::numeric_limits<double>::infinity();
}

// Water on both sides of a keel keeps its pair, with the length of the way around it.
TEST(BodySurface3d, AKeelThatComesBetweenAPairLengthensIt) {
  const Parameters p = basin(0.24, 0.1, l0, 0.4);
  EXPECT_NEAR(length_across_keel(p, 0.1, 0.01, 0.01), 2 * std::hypot(0.9 * l0, 0.3 * l0), 1e-9);
}

// So does water on both sides of a seam of the tank, whose ends of the keel are one place.
TEST(BodySurface3d, AKeelOverASeamLengthensAPairAsAnyOther) {
  Parameters p = basin(0.24, 0.1, l0, 0.4);
  p.periodic[2] = true;
  const double way = std::hypot(2 * std::hypot(0.9 * l0, 0.3 * l0), 0.8 * l0);
  EXPECT_NEAR(length_across_keel(p, 0.24, 0.01, 0.01 + 0.8 * l0), way, 1e-9);
  for (const double before : {0.1, 0.4, 0.7})
    EXPECT_NEAR(length_across_keel(p, 0.24, 0.12 - before * l0, -0.12 + (0.8 - before) * l0), way, 1e-9);
}

TEST(BodySurface3d, AnEdgeThatDoesNotCountIsNoEndOfAFace) {
  const BodySurface3d body = box_body();
  const Vector3d down(0, -1, 0);
  const auto at_x = [](bool sharp, const Vector3d& place) { return sharp && place.x() > 0.1 - 1e-9; };
  const auto inside = [&](const Vector3d& x) { return body.within(wet_point(body, down, x), x, at_x); };
  EXPECT_NEAR(inside({0.092, -0.005, 0.049}), 0.008, 1e-12);
  EXPECT_NEAR(inside({0.107, -0.005, 0.03}), -0.007, 1e-12);
  EXPECT_EQ(inside({0.08, -0.005, 0.055}), std::numeric_limits<double>::infinity());  // past the other edge
  EXPECT_EQ(inside({0, -0.005, 0.049}), std::numeric_limits<double>::infinity());     // too far away
  const BodySurface3d sphere = sphere_body(0.05);
  EXPECT_EQ(sphere.within(0, sphere.point(0)), std::numeric_limits<double>::infinity());
}

TEST(BodySurface3d, PlaneFacesBetweenCornersOfAtMostARightAngleAreFound) {
  const BodySurface3d box = box_body(), sphere = sphere_body(0.05);
  for (int k = 0; k < box.points(); ++k) EXPECT_TRUE(box.is_between_sharp_corners(k) && !box.is_curved(k));
  for (int k = 0; k < sphere.points(); ++k)
    EXPECT_TRUE(!sphere.is_between_sharp_corners(k) && sphere.is_curved(k));
  // A disc: its level faces are plane, its rim is curved.
  const BodySurface3d disc(disc_surface(0.1, 0, 0.04, l0), l0, reach);
  for (int k = 0; k < disc.points(); ++k) {
    EXPECT_EQ(disc.is_between_sharp_corners(k), std::abs(disc.normal(k).y()) > 0.9) << disc.point(k);
    EXPECT_EQ(disc.is_curved(k), std::abs(disc.normal(k).y()) < 0.9) << disc.point(k);
  }
  // Apex and chines of a wedge of 30 degrees are blunt. The corners of its deck and of its ends are not.
  const auto corner =
      structure::wedge_polygon({.deadrise = std::numbers::pi / 6, .width = 0.2, .height = 0.12});
  const BodySurface3d wedge(structure::prism_surface(structure::outline(corner, l0), 0.1, 0, l0), l0, reach);
  const int deck = wet_point(wedge, {0, 1, 0}, {0, 0.12, 0});
  ASSERT_GE(deck, 0);
  EXPECT_TRUE(wedge.is_between_sharp_corners(deck));
  for (int k = 0; k < wedge.points(); ++k) {
    const bool blunt = wedge.normal(k).y() < -0.1 || std::abs(wedge.normal(k).x()) > 0.9;
    EXPECT_EQ(wedge.is_between_sharp_corners(k), !blunt) << wedge.point(k);
    EXPECT_FALSE(wedge.is_curved(k)) << wedge.point(k);
  }
}

TEST(BodySurface3d, LoadsOnWetPointsKeepForceAndMomentOnTheMesh) {
  const BodySurface3d body = sphere_body(0.05);
  const Points load = Points::Random(3, body.points());
  const Points nodes = body.spread(load);
  Vector3d force = Vector3d::Zero(), moment = force, there = force;
  for (int k = 0; k < body.points(); ++k) moment += body.point(k).cross(Vector3d(load.col(k)));
  for (Eigen::Index k = 0; k < nodes.cols(); ++k)
    there += Vector3d(body.mesh().position.col(k)).cross(Vector3d(nodes.col(k)));
  force = load.rowwise().sum() - nodes.rowwise().sum();
  EXPECT_LT(force.norm(), 1e-12);
  EXPECT_LT((moment - there).norm(), 1e-12);
}

TEST(BodySurface3d, OpenAndInvertedSurfacesAreRefused) {
  InterfaceMesh mesh = box_surface({0, 0, 0}, {0.2, 0.06, 0.1}, l0);
  InterfaceMesh open = mesh;
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  EXPECT_THROW(BodySurface3d(open, l0, reach), Error);
  mesh.faces.row(0).swap(mesh.faces.row(1));
  EXPECT_THROW(BodySurface3d(mesh, l0, reach), Error);
}

}  // namespace body_surface_3d_test
}  // namespace strake::fluid
