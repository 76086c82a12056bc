#include "coupler/precice/exchanged_data.hpp"
#include "coupler/precice/solver_mesh.hpp"
#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace strake {
namespace waveform_test {

Eigen::MatrixXd number(double value) {
  return Eigen::MatrixXd::Constant(1, 1, value);
}

/// Samples of a function at equal distances over [start, start + 1], without the start.
std::vector<Waveform::Knot> samples(double start, int n, double (*f)(double)) {
  std::vector<Waveform::Knot> knots;
  for (int i = 1; i <= n; ++i) knots.push_back({start + i / double(n), number(f(start + i / double(n)))});
  return knots;
}

TEST(Waveform, IsLinearBetweenTheEndsOfAWindow) {
  Waveform waveform(1);
  waveform.begin(0, number(4));
  waveform.set_window(0, {{2, number(8)}});
  EXPECT_DOUBLE_EQ(waveform.at(0)(0, 0), 4);
  EXPECT_DOUBLE_EQ(waveform.at(0.5)(0, 0), 5);
  EXPECT_DOUBLE_EQ(waveform.at(2)(0, 0), 8);
  waveform.set_window(0, {{2, number(6)}});  // once more: another guess of the end
  EXPECT_DOUBLE_EQ(waveform.at(1)(0, 0), 5);
  waveform.commit();
  waveform.set_window(2, {{3, number(0)}});
  EXPECT_DOUBLE_EQ(waveform.at(2)(0, 0), 6);
  EXPECT_DOUBLE_EQ(waveform.at(2.5)(0, 0), 3);
}

TEST(Waveform, BeginsAtZeroWhereNothingIsKnown) {
  Waveform waveform(1);
  EXPECT_TRUE(waveform.empty());
  waveform.set_window(0, {{1, number(2)}});
  EXPECT_DOUBLE_EQ(waveform.at(0)(0, 0), 0);
  EXPECT_DOUBLE_EQ(waveform.at(0.5)(0, 0), 1);
}

TEST(Waveform, IsConstantOverEachStepWithDegreeZero) {
  Waveform waveform(0);
  waveform.begin(0, number(9));
  waveform.set_window(0, {{0.5, number(1)}, {1, number(2)}});
  EXPECT_DOUBLE_EQ(waveform.at(0)(0, 0), 9) << "as in preCICE: what held where the window begins";
  EXPECT_DOUBLE_EQ(waveform.at(0.4)(0, 0), 1);
  EXPECT_DOUBLE_EQ(waveform.at(0.5)(0, 0), 1);
  EXPECT_DOUBLE_EQ(waveform.at(0.6)(0, 0), 2);
}

// A polynomial of the degree goes through exactly, wherever it is read.
TEST(Waveform, ReproducesPolynomialsOfItsDegree) {
  const auto cubic = [](double t) { return 1 + t * (2 + t * (-3 + t)); };
  for (const double start : {0.0, 3.0}) {
    Waveform waveform(3);
    waveform.begin(start, number(cubic(start)));
    waveform.set_window(start, samples(start, 5, +cubic));
    for (double t = start; t <= start + 1; t += 0.07)
      EXPECT_NEAR(waveform.at(t)(0, 0), cubic(t), 1e-12 * std::abs(cubic(t)) + 1e-12);
  }
}

// Samples that begin before the window make the start of it unnecessary.
TEST(Waveform, TakesSamplesFromBeforeTheWindow) {
  Waveform waveform(1);
  waveform.set_window(1, {{0.5, number(1)}, {1.5, number(3)}, {2, number(0)}});
  EXPECT_DOUBLE_EQ(waveform.at(1)(0, 0), 2);
  EXPECT_DOUBLE_EQ(waveform.at(1.75)(0, 0), 1.5);
}

TEST(SolverMesh, CutsQuadrilateralsAlongTheShorterDiagonalAndKeepsEachFaceOnce) {
  SolverMesh mesh("M", 3);
  for (const std::vector<double>& x :
       std::vector<std::vector<double>>{{0, 0, 0}, {2, 0, 0}, {1.5, 1, 0}, {0, 1, 0}})
    mesh.add_vertex(x);
  mesh.add_quad(0, 1, 2, 3);  // diagonals 0-2: 1.80, 1-3: 2.24
  mesh.add_triangle(2, 1, 0);
  mesh.add_edge(0, 1);  // no face of a surface in space
  const InterfaceMesh built = mesh.interface_mesh();
  ASSERT_EQ(built.faces.cols(), 2);
  EXPECT_EQ(built.faces.col(0), Eigen::Vector3i(0, 1, 2));
  EXPECT_EQ(built.faces.col(1), Eigen::Vector3i(0, 2, 3));
  EXPECT_EQ(built.position(0, 2), 1.5);
  EXPECT_THROW(mesh.add_quad(0, 1, 2, 4), Error);
}

TEST(SolverMesh, HasEdgesAsFacesInThePlane) {
  SolverMesh mesh("M", 2);
  for (const double x : {0.0, 1.0, 2.0}) mesh.add_vertex(std::vector<double>{x, 5});
  mesh.add_edge(0, 1), mesh.add_edge(1, 0), mesh.add_edge(1, 2), mesh.add_triangle(0, 1, 2);
  const InterfaceMesh built = mesh.interface_mesh();
  EXPECT_EQ(built.dimension, 2);
  EXPECT_EQ(built.faces, (Eigen::MatrixXi(2, 2) << 0, 1, 1, 2).finished());
  EXPECT_EQ(built.position.row(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_THROW(mesh.add_quad(0, 1, 2, 0), Error);
}

}  // namespace waveform_test
}  // namespace strake
