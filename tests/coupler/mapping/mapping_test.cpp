#include "coupler/mapping/mapping.hpp"

#include "coupler/mapping/mapping_parts.hpp"
#include "tests/coupler/surfaces.hpp"
#include "tests/proto/refusal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace strake {
namespace mapping_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

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
    for (const char* kind : {"nearest-neighbour", "nearest-projection", "linear-cell", "radial-basis"}) {
      const Mapping mapping = make_mapping({.kind = kind}, p.structure, p.fluid);
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
    for (const char* kind : {"nearest-neighbour", "nearest-projection", "linear-cell"}) {
      const Mapping mapping = make_mapping({.kind = kind}, p.structure, p.fluid);
      const Vector3d rigid(0.1, -6.26, 3);
      const Field u = {"velocity", "m/s", false, rigid.replicate(1, p.structure.position.cols())};
      EXPECT_LE((mapping.consistent(u).value.colwise() - rigid).cwiseAbs().maxCoeff(), 1e-14 * rigid.norm());
    }
}

// Fluid points above the inside of a flat face: the foot of the perpendicular carries the linear field
// exactly.
TEST(Mapping, ReproducesLinearFieldsByProjectionOnFlatFaces) {
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

// Beyond a border on a plane the linear function of the border face continues for a face's length. A
// projection takes the border's value.
TEST(Mapping, ReproducesLinearFieldsByCellsWhereTheFluidOverhangs) {
  const InterfaceMesh line = strip("structure", 13, 0.4), plane = sheet(5);
  const InterfaceMesh below =
      scattered(line, 50, [](double a, double) { return Vector3d(0.44 * a - 0.02, 0, 0); });
  const InterfaceMesh on = scattered(plane, 300, [](double a, double b) {
    const double x = 1.2 * a - 0.1, y = 2.2 * b - 0.1;
    return Vector3d(x, y, 0.5 * x);
  });
  for (const Pair& p : {Pair{line, below}, Pair{plane, on}}) {
    const Field u = {"displacement", "m", false, linear(p.structure.position)};
    const MatrixXd exact = linear(p.fluid.position);
    const Mapping cell = linear_cell(p.structure, p.fluid),
                  projection = nearest_projection(p.structure, p.fluid);
    EXPECT_LE((cell.consistent(u).value - exact).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT((projection.consistent(u).value - exact).cwiseAbs().maxCoeff(), 1e-2);
    EXPECT_GT(cell.quality().outside, 0);
    EXPECT_EQ(cell.quality().outside, projection.quality().outside);
  }
}

TEST(Mapping, TakesTheBordersValueFartherThanAFaceBeyondIt) {
  const InterfaceMesh line = strip("structure", 4, 0.4);
  InterfaceMesh fluid = {"fluid", 2, Points::Zero(3, 2), {}, {}};
  fluid.position.row(0) << 0.45, 0.55;
  MatrixXd expected(2, 5);
  expected << 0, 0, 0, -0.5, 1.5, 0, 0, 0, 0, 1;
  EXPECT_LE((MatrixXd(linear_cell(line, fluid).weights()) - expected).cwiseAbs().maxCoeff(), 1e-12);
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
  for (const char* kind : {"nearest-neighbour", "nearest-projection", "linear-cell", "identity"}) {
    const Mapping mapping = make_mapping({.kind = kind}, sheet(4), sheet(4));
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

TEST(Mapping, GivesFieldsOfAnyNumberOfComponents) {
  const Pair p = pairs()[2];
  const Mapping mapping = nearest_projection(p.structure, p.fluid);
  for (const Index components : {1, 2, 3, 5}) {
    const MatrixXd value = MatrixXd::Random(components, p.structure.position.cols());
    const MatrixXd expected = (MatrixXd(mapping.weights()) * value.transpose()).transpose();
    const Field mapped = mapping.consistent({"pressure", "Pa", false, value});
    EXPECT_LE((mapped.value - expected).cwiseAbs().maxCoeff(), 1e-14) << components;
    EXPECT_EQ(mapped.quantity, "pressure");
  }
}

// The fluid is coarser than the structure. The transpose of a nearest neighbour loads a third of its points,
// a force per area loads all.
TEST(Mapping, LoadsEveryStructurePointByTheForcePerArea) {
  const InterfaceMesh structure = strip("structure", 30, 0.4), fluid = strip("fluid", 11, 0.4);
  const Eigen::VectorXd area = point_areas(fluid), on = point_areas(structure);
  const double pressure = 2e5;
  Field f = {"force", "N", true, MatrixXd::Zero(3, area.size())};
  f.value.edit().row(1) = pressure * area.transpose();
  for (const char* kind : {"nearest-neighbour", "nearest-projection", "radial-basis"}) {
    EXPECT_GT(make_mapping({.kind = "nearest-neighbour"}, structure, fluid).quality().without_load, 15);
    const Mapping mapping = make_mapping({.kind = kind, .constraint = "consistent"}, structure, fluid);
    EXPECT_EQ(mapping.quality().without_load, 0) << kind;
    // An even pressure is a constant.
    const MatrixXd force = mapping.force(f).value;
    EXPECT_LE((force.row(1) - pressure * on.transpose()).cwiseAbs().maxCoeff(),
              1e-9 * pressure * on.maxCoeff())
        << kind;
  }
}

TEST(Mapping, KeepsTheSumOfTheForceWhereItIsScaled) {
  const InterfaceMesh structure = wavy(13), fluid = wavy(9, 0.3);
  const Field f = {"force", "N", true, random_values(fluid.position.cols(), 5)};
  const Vector3d sum = f.value.rowwise().sum();
  for (const char* kind : {"nearest-neighbour", "nearest-projection", "linear-cell", "radial-basis"}) {
    const Mapping plain = make_mapping({.kind = kind, .constraint = "consistent"}, structure, fluid),
                  scaled = make_mapping({.kind = kind, .constraint = "scaled-consistent"}, structure, fluid);
    EXPECT_GT((plain.force(f).value.rowwise().sum() - sum).norm(), 1e-3 * sum.norm()) << kind;
    EXPECT_LE((scaled.force(f).value.rowwise().sum() - sum).norm(), 1e-12 * f.value.norm()) << kind;
    EXPECT_EQ(make_mapping({.kind = kind}, structure, fluid).force(f).value, plain.conservative(f).value)
        << kind;
  }
}

TEST(Mapping, MatchesTheIntegralOfAPressureAndLeavesDryPointsDry) {
  const InterfaceMesh structure = wavy(20), fluid = wavy(8, 0.3);
  const Eigen::VectorXd from = point_areas(fluid), to = point_areas(structure);
  MatrixXd pressure = (fluid.position.row(0).array() - 0.4).max(0);
  const Eigen::VectorXd integral = pressure * from;
  MatrixXd mapped =
      nearest_projection(fluid, structure).consistent({"pressure", "Pa", false, pressure}).value;
  const MatrixXd plain = mapped;
  EXPECT_GT(std::abs((mapped * to - integral)[0]), 1e-3 * integral[0]);
  match_integral(mapped, to, integral);
  EXPECT_NEAR((mapped * to)[0], integral[0], 1e-13 * integral[0]);
  for (Index i = 0; i < plain.cols(); ++i)
    if (plain(0, i) == 0) {
      EXPECT_EQ(mapped(0, i), 0) << i;
    }
  const Mapping scaled =
      make_mapping({.kind = "nearest-projection", .constraint = "scaled-consistent"}, fluid, structure);
  EXPECT_EQ(scaled.per_area({"pressure", "Pa", false, pressure}).value, mapped);
  EXPECT_EQ(scaled.consistent({"pressure", "Pa", false, pressure}).value, plain);
  // Of one sign: the usual scaling by one factor.
  EXPECT_LE((mapped - integral[0] / (plain * to)[0] * plain).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Mapping, AddsUpTheAreaOfASurface) {
  EXPECT_NEAR(point_areas(sheet(7)).sum(), 2 * std::sqrt(1.25), 1e-14);
  EXPECT_NEAR(point_areas(strip("line", 9, 0.4)).sum(), 0.4, 1e-15);
  EXPECT_NEAR(point_areas(strip("line", 4, 0.4))[0], 0.05, 1e-15);
}

// Points without faces of their own get the part of the other's surface that is nearest to them.
TEST(Mapping, TakesAreasFromTheOtherSurfaceWhereAMeshHasNoFaces) {
  const InterfaceMesh plane = sheet(8), line = strip("structure", 10, 0.4);
  EXPECT_NEAR(nearest_areas(wavy(5).position, plane).sum(), point_areas(plane).sum(), 1e-13);
  const Eigen::VectorXd area = nearest_areas(strip("fluid", 4, 0.4).position, line, 16);
  EXPECT_LE((area - point_areas(strip("fluid", 4, 0.4))).cwiseAbs().maxCoeff(), 0.04 / 16);
  InterfaceMesh fluid = sheet(12);
  fluid.faces.resize(3, 0);
  const Field f = {"force", "N", true, random_values(fluid.position.cols(), 5)};
  const Mapping mapping =
      make_mapping({.kind = "radial-basis", .constraint = "scaled-consistent"}, plane, fluid);
  EXPECT_LE((mapping.force(f).value.rowwise().sum() - f.value.rowwise().sum()).norm(),
            1e-12 * f.value.norm());
}

TEST(Mapping, SaysWhatItLeavesToBeDesired) {
  const InterfaceMesh line = strip("structure", 4, 0.4);
  const InterfaceMesh fluid = strip("fluid", 1, 0.45, -0.01);
  const auto lines = quality_lines(nearest_projection(line, fluid).quality(), fluid.position);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0], "largest distance 0.051 m, fluid point 1 at (0.45, -0.01, 0) m");
  EXPECT_EQ(lines[1], "1 of 2 fluid points are not covered by the structure's surface");
  EXPECT_EQ(lines[2], "3 of 5 structure points feel no load");
  EXPECT_EQ(lines[3], "rows sum to 1 within 0.0e+00, 1 structure points behind a fluid point");
  const auto back = quality_lines(nearest_neighbour(fluid, line).quality(), line.position, true);
  EXPECT_EQ(back[2], "0 of 2 fluid points are not used");
  EXPECT_EQ(back[3], "rows sum to 1 within 0.0e+00, 1 fluid points behind a structure point");
  const auto radial = quality_lines(radial_basis(line, fluid).quality(), fluid.position);
  ASSERT_EQ(radial.size(), 5u);
  EXPECT_NE(radial[4].find("the worst of 1 system of 5 points"), std::string::npos) << radial[4];
}

TEST(Mapping, RefusesMeshesThatDoNotBelongTogether) {
  const InterfaceMesh line = strip("structure", 4, 0.4), plane = sheet(2);
  InterfaceMesh empty = line, bare = line, broken = line, nowhere = line;
  empty.position.resize(3, 0);
  bare.faces.resize(2, 0);
  broken.faces(1, 2) = 9;
  nowhere.position(1, 3) = NAN;
  expect_refused([&] { nearest_projection(empty, line); }, "structure's interface has no points");
  expect_refused([&] { nearest_neighbour(line, empty); }, "fluid's interface has no points");
  expect_refused([&] { nearest_neighbour(bare, empty); }, "points but no faces");
  expect_refused([&] { nearest_projection(line, plane); }, "2-dimensional");
  expect_refused([&] { nearest_projection(bare, line); }, "no faces");
  expect_refused([&] { nearest_projection(broken, line); }, "names point 9");
  expect_refused([&] { nearest_projection(line, nowhere); }, "not finite");
  expect_refused([&] { nearest_projection(line, strip("fluid", 4, 0.4, 0.3), 0.1); },
                 "0.3 m from the structure");
  expect_refused([&] { identity(line, strip("fluid", 5, 0.4)); }, "identity");
  expect_refused([&] { identity(line, strip("fluid", 4, 0.5)); }, "m from the structure");
  expect_refused([&] { radial_basis(line, strip("fluid", 4, 0.4, 0.3), {}, 0.1); },
                 "0.3 m from the structure");
  expect_refused([&] { make_mapping({.kind = "nearest-neighbour", .constraint = "consistent"}, bare, bare); },
                 "point 0 of the structure's interface stands for no part of a face");
  expect_refused([&] { make_mapping({.kind = "nearest-neighbour", .constraint = "scaled"}, line, line); },
                 "\"scaled\" is not a constraint");
  expect_refused([&] { make_mapping({.kind = "radial"}, line, line); }, "nearest-projection");
}

}  // namespace mapping_test
}  // namespace strake
