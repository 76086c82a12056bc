#include "coupler/mapping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "proto/error.hpp"

namespace strake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// The underside of a plate, walked from left to right: n segments.
InterfaceMesh strip(const std::string& name, int n, double length, double y = 0) {
  InterfaceMesh mesh = {name, 2, Points::Zero(3, n + 1), Eigen::MatrixXi(2, n), {}};
  for (int i = 0; i <= n; ++i) mesh.position.col(i) = Vector3d(length * i / n, y, 0);
  for (int i = 0; i < n; ++i) mesh.faces.col(i) = Eigen::Vector2i(i, i + 1);
  return mesh;
}

/// A rectangle of 2 m² triangles in the plane z = x/2.
InterfaceMesh sheet(int m) {
  InterfaceMesh mesh = {"sheet", 3, Points::Zero(3, (m + 1) * (m + 1)), Eigen::MatrixXi(3, 2 * m * m), {}};
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= m; ++i) {
      const double x = 1.0 * i / m;
      mesh.position.col(j * (m + 1) + i) = Vector3d(x, 2.0 * j / m, 0.5 * x);
    }
  Index f = 0;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      const int a = j * (m + 1) + i;
      mesh.faces.col(f++) = Eigen::Vector3i(a, a + 1, a + m + 2);
      mesh.faces.col(f++) = Eigen::Vector3i(a, a + m + 2, a + m + 1);
    }
  return mesh;
}

InterfaceMesh scattered(const InterfaceMesh& like, int n,
                        const std::function<Vector3d(double, double)>& place) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  InterfaceMesh mesh = {"fluid", like.dimension, Points(3, n), {}, {}};
  for (int i = 0; i < n; ++i) {
    const double a = unit(random), b = unit(random);
    mesh.position.col(i) = place(a, b);
  }
  return mesh;
}

MatrixXd random_values(Index n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(3, n, [&] { return normal(random); });
}

double dot(const MatrixXd& a, const MatrixXd& b) {
  return a.reshaped().dot(b.reshaped());
}

struct Pair {
  InterfaceMesh structure, fluid;
};

std::vector<Pair> pairs() {
  const InterfaceMesh line = strip("structure", 37, 0.4), plane = sheet(6);
  return {
      {line, strip("fluid", 40, 0.4, -1e-3)},
      {line, scattered(line, 60, [](double a, double) { return Vector3d(0.44 * a - 0.02, -1e-3, 0); })},
      {plane, scattered(plane, 200, [](double a, double b) { return Vector3d(a, 2 * b, 0.5 * a + 0.01); })}};
}

TEST(Mapping, DoesTheSameVirtualWorkOnBothSidesAndHasRowsThatSumToOne) {
  for (const Pair& p : pairs())
    for (const char* kind : {"nearest-neighbour", "nearest-projection"}) {
      const Mapping mapping = make_mapping(kind, p.structure, p.fluid);
      EXPECT_LE(mapping.quality().row_sum_error, 1e-12);
      const Field u = {"displacement", "m", false, random_values(p.structure.position.cols(), 1)};
      const Field f = {"force", "N", true, random_values(p.fluid.position.cols(), 2)};
      const double fluid = dot(f.value, mapping.consistent(u).value);
      const double structure = dot(mapping.conservative(f).value, u.value);
      EXPECT_NEAR(fluid, structure, 1e-12 * std::abs(fluid));
      // Rows that sum to one also keep the whole force.
      const Vector3d lost = mapping.conservative(f).value.rowwise().sum() - f.value.rowwise().sum();
      EXPECT_LE(lost.norm(), 1e-12 * f.value.norm());
    }
}

TEST(Mapping, ReproducesConstants) {
  for (const Pair& p : pairs())
    for (const char* kind : {"nearest-neighbour", "nearest-projection"}) {
      const Mapping mapping = make_mapping(kind, p.structure, p.fluid);
      const Vector3d rigid(0.1, -6.26, 3);
      const Field u = {"velocity", "m/s", false, rigid.replicate(1, p.structure.position.cols())};
      EXPECT_LE((mapping.consistent(u).value.colwise() - rigid).cwiseAbs().maxCoeff(), 1e-14 * rigid.norm());
    }
}

// Fluid points above the inside of a flat face: the foot of the perpendicular carries the linear field
// exactly.
TEST(Mapping, ReproducesLinearFieldsByProjectionOnFlatFaces) {
  const auto linear = [](const Points& x) {
    Eigen::Matrix3d gradient;
    gradient << 1, 2, -1, 0.5, 0, 3, -2, 1, 1;
    return MatrixXd(gradient * x);
  };
  const InterfaceMesh line = strip("structure", 13, 0.4);
  const InterfaceMesh below = scattered(line, 50, [](double a, double) { return Vector3d(0.4 * a, 0, 0); });
  const InterfaceMesh plane = sheet(5);
  const InterfaceMesh on =
      scattered(plane, 300, [](double a, double b) { return Vector3d(a, 2 * b, 0.5 * a); });
  for (const Pair& p : {Pair{line, below}, Pair{plane, on}}) {
    const Mapping mapping = nearest_projection(p.structure, p.fluid);
    const Field u = {"displacement", "m", false, linear(p.structure.position)};
    EXPECT_LE((mapping.consistent(u).value - linear(p.fluid.position)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(mapping.quality().outside, 0);
    EXPECT_LE(mapping.quality().largest_distance, 1e-12);
  }
}

TEST(Mapping, KeepsTheMomentOfPressureOnAFlatFace) {
  const InterfaceMesh line = strip("structure", 13, 0.4);
  const InterfaceMesh fluid = strip("fluid", 40, 0.4);
  const Mapping mapping = nearest_projection(line, fluid);
  const Field f = {"force", "N", true, random_values(fluid.position.cols(), 3)};
  const MatrixXd on_structure = mapping.conservative(f).value;
  const double moment_fluid = fluid.position.row(0).dot(f.value.row(1));
  EXPECT_NEAR(line.position.row(0).dot(on_structure.row(1)), moment_fluid, 1e-12 * std::abs(moment_fluid));
}

TEST(Mapping, IsTheIdentityBetweenEqualMeshes) {
  for (const char* kind : {"nearest-neighbour", "nearest-projection", "identity"}) {
    const Mapping mapping = make_mapping(kind, sheet(4), sheet(4));
    EXPECT_EQ((MatrixXd(mapping.weights()) - MatrixXd::Identity(25, 25)).cwiseAbs().maxCoeff(), 0) << kind;
    EXPECT_EQ(mapping.quality().outside, 0) << kind;
  }
}

TEST(Mapping, FallsBackToTheNearestEdgeAndVertexBeyondTheFaces) {
  InterfaceMesh triangle = {"triangle", 3, Points(3, 3), Eigen::MatrixXi(3, 1), {}};
  triangle.position << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  triangle.faces << 0, 1, 2;
  InterfaceMesh fluid = {"fluid", 3, Points(3, 3), {}, {}};
  fluid.position.col(0) = Vector3d(0.25, -0.5, 0.1);  // beyond the edge from 0 to 1
  fluid.position.col(1) = Vector3d(2, -1, 0);         // beyond vertex 1
  fluid.position.col(2) = Vector3d(0.25, 0.25, -3);   // below the face
  const Mapping mapping = nearest_projection(triangle, fluid);
  MatrixXd expected(3, 3);
  expected << 0.75, 0.25, 0, 0, 1, 0, 0.5, 0.25, 0.25;
  EXPECT_LE((MatrixXd(mapping.weights()) - expected).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(mapping.quality().outside, 2);
  EXPECT_EQ(mapping.quality().farthest, 2);
  EXPECT_NEAR(mapping.quality().largest_distance, 3, 1e-14);
}

TEST(Mapping, TakesTheFirstOfEquallyNearPoints) {
  const InterfaceMesh line = strip("structure", 4, 4);
  InterfaceMesh fluid = {"fluid", 2, Points::Zero(3, 1), {}, {}};
  fluid.position(0, 0) = 2.5;
  EXPECT_EQ(nearest_neighbour(line, fluid).weights().coeff(0, 2), 1);
}

TEST(Mapping, CountsStructurePointsThatFeelNoLoad) {
  const Mapping mapping = nearest_neighbour(strip("structure", 8, 0.4), strip("fluid", 2, 0.4));
  EXPECT_EQ(mapping.quality().without_load, 6);
}

void refused(const std::function<void()>& act, const std::string& part) {
  try {
    act();
    FAIL() << "no error; expected one with: " << part;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_NE(to_text(e).find(part), std::string::npos) << to_text(e);
  }
}

TEST(Mapping, RefusesMeshesThatDoNotBelongTogether) {
  const InterfaceMesh line = strip("structure", 4, 0.4), plane = sheet(2);
  InterfaceMesh empty = line, bare = line, broken = line, nowhere = line;
  empty.position.resize(3, 0);
  bare.faces.resize(2, 0);
  broken.faces(1, 2) = 9;
  nowhere.position(1, 3) = NAN;
  refused([&] { nearest_projection(empty, line); }, "structure's interface has no points");
  refused([&] { nearest_neighbour(line, empty); }, "fluid's interface has no points");
  refused([&] { nearest_projection(line, plane); }, "2-dimensional");
  refused([&] { nearest_projection(bare, line); }, "no faces");
  refused([&] { nearest_projection(broken, line); }, "names point 9");
  refused([&] { nearest_projection(line, nowhere); }, "not finite");
  refused([&] { nearest_projection(line, strip("fluid", 4, 0.4, 0.3), 0.1); }, "0.3 m from the structure");
  refused([&] { identity(line, strip("fluid", 5, 0.4)); }, "identity");
  refused([&] { identity(line, strip("fluid", 4, 0.5)); }, "m from the structure");
  refused([&] { make_mapping("radial", line, line); }, "nearest-projection");
}

}  // namespace
}  // namespace strake
