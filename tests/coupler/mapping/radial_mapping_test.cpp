#include "coupler/mapping/mapping.hpp"
#include "coupler/mapping/partition_of_unity.hpp"
#include "tests/coupler/surfaces.hpp"
#include "tests/proto/refusal.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <vector>

namespace strake {
namespace radial_mapping_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

const std::vector<std::string> functions = {"wendland-c2", "wendland-c4", "wendland-c6", "thin-plate"};

/// A smooth displacement with a value, a slope and a bend everywhere.
MatrixXd smooth(const Points& x) {
  MatrixXd u(3, x.cols());
  for (Index i = 0; i < x.cols(); ++i) {
    const Vector3d p = x.col(i);
    u.col(i) = Vector3d(std::sin(3 * p.x()) * std::cos(4 * p.y()) + p.z(), std::exp(p.x() * p.y()),
                        std::cos(5 * (p.x() - p.y())));
  }
  return u;
}

double error_of(const Mapping& mapping, const InterfaceMesh& structure, const InterfaceMesh& fluid) {
  const Field u = {"displacement", "m", false, smooth(structure.position)};
  return (mapping.consistent(u).value - smooth(fluid.position)).cwiseAbs().maxCoeff();
}

/// A curve in the plane, as the section of a hull.
InterfaceMesh bow(int n, double shift = 0) {
  InterfaceMesh mesh = strip("bow", n, 1);
  for (Index i = 0; i <= n; ++i) {
    const double x = mesh.position(0, i) + shift / n;
    mesh.position.col(i) = Vector3d(x, 0.2 * std::cos(3 * x), 0);
  }
  return mesh;
}

// The tolerance is 1e-12 and not 1e-14. The weights have both signs and the sum of their magnitudes is above
// 1; each carries the round-off of a solved system.
TEST(RadialBasis, ReproducesConstantsAndDoesTheSameVirtualWork) {
  for (const auto& [structure, fluid] :
       {std::pair{wavy(24), wavy(31, 0.3)}, std::pair{bow(90), bow(70, 0.3)}})
    for (const std::string& function : functions)
      for (const char* solve : {"partition", "global"})
        for (const char* polynomial : {"linear", "constant"}) {
          const Mapping mapping = radial_basis(
              structure, fluid, {.function = function, .polynomial = polynomial, .solve = solve});
          const std::string name = function + " " + solve + " " + polynomial;
          EXPECT_LE(mapping.quality().row_sum_error, 1e-12) << name;
          const Field f = {"force", "N", true, random_values(fluid.position.cols(), 2)};
          const Field u = {"displacement", "m", false, random_values(structure.position.cols(), 1)};
          const double on_fluid = dot(f.value, mapping.consistent(u).value);
          const double on_structure = dot(mapping.conservative(f).value, u.value);
          EXPECT_NEAR(on_fluid, on_structure, 1e-12 * f.value.norm() * u.value.norm()) << name;
          const Vector3d lost = mapping.conservative(f).value.rowwise().sum() - f.value.rowwise().sum();
          EXPECT_LE(lost.norm(), 1e-12 * f.value.norm()) << name;
        }
}

double error_of_a_linear_field(const Mapping& mapping, const InterfaceMesh& structure,
                               const InterfaceMesh& fluid) {
  const Field u = {"displacement", "m", false, linear(structure.position)};
  return (mapping.consistent(u).value - linear(fluid.position)).cwiseAbs().maxCoeff();
}

TEST(RadialBasis, ReproducesLinearFieldsAndKeepsMoments) {
  for (const auto& [structure, fluid] :
       {std::pair{wavy(24), wavy(31, 0.3)}, std::pair{bow(90), bow(70, 0.3)}})
    for (const std::string& function : functions)
      for (const char* solve : {"partition", "global"}) {
        const Mapping mapping = radial_basis(structure, fluid, {.function = function, .solve = solve});
        EXPECT_LE(error_of_a_linear_field(mapping, structure, fluid), 1e-11) << function << " " << solve;
        // Displacements of a rigid turn are linear: the moment of the force is kept.
        const Field f = {"force", "N", true, random_values(fluid.position.cols(), 2)};
        const MatrixXd on_structure = mapping.conservative(f).value;
        Vector3d moment = Vector3d::Zero();
        for (Index i = 0; i < fluid.position.cols(); ++i)
          moment += Vector3d(fluid.position.col(i)).cross(Vector3d(f.value.col(i)));
        for (Index j = 0; j < structure.position.cols(); ++j)
          moment -= Vector3d(structure.position.col(j)).cross(Vector3d(on_structure.col(j)));
        EXPECT_LE(moment.norm(), 1e-11 * f.value.norm()) << function << " " << solve;
      }
}

// A plane has no extent across: a linear function across it is not determined and is left out.
TEST(RadialBasis, ReproducesLinearFieldsOnPlanesAndLines) {
  const InterfaceMesh plane = sheet(14), line = strip("structure", 80, 0.4);
  const InterfaceMesh on_plane =
      scattered(plane, 300, [](double a, double b) { return Vector3d(a, 2 * b, 0.5 * a); });
  const InterfaceMesh on_line = scattered(line, 90, [](double a, double) { return Vector3d(0.4 * a, 0, 0); });
  for (const auto& [structure, fluid] : {std::pair{plane, on_plane}, std::pair{line, on_line}})
    for (const std::string& function : functions)
      for (const char* solve : {"partition", "global"}) {
        const Mapping mapping = radial_basis(structure, fluid, {.function = function, .solve = solve});
        EXPECT_LE(error_of_a_linear_field(mapping, structure, fluid), 1e-11) << function << " " << solve;
      }
}

// Sources that are almost flat, with targets far off their plane. A slope across the plane, fitted to the
// small extent there, would be amplified a thousandfold.
TEST(RadialBasis, DoesNotFollowASlopeThatThePointsBarelyShow) {
  const auto nearly_flat = [](double height) {
    return patchwork("plate", 20,
                     [&](double a, double b) { return Vector3d(a, b, height * std::sin(9 * a * b)); });
  };
  const InterfaceMesh structure = nearly_flat(1e-4);
  InterfaceMesh fluid = nearly_flat(1e-4);
  fluid.position.row(2).array() += 0.1;
  const Mapping mapping = radial_basis(structure, fluid);
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    double size = 0;
    for (Mapping::Matrix::InnerIterator w(mapping.weights(), i); w; ++w) size += std::abs(w.value());
    ASSERT_LE(size, 50) << i;  // with that slope 0.1/1e-4 = 1000
  }
}

TEST(RadialBasis, InterpolatesTheValuesOfItsPoints) {
  for (const std::string& function : functions) {
    const Mapping mapping = radial_basis(wavy(20), wavy(20), {.function = function});
    const MatrixXd off = MatrixXd(mapping.weights()) - MatrixXd::Identity(441, 441);
    EXPECT_LE(off.cwiseAbs().maxCoeff(), 1e-7) << function << ", condition " << mapping.quality().condition;
  }
}

struct Convergence {
  std::string kind, function;
  double least;  // order that the method promises
};

// The spacing is halved twice; the error is the largest anywhere, including borders, where the fluid
// overhangs by 0.3 h. There a projection keeps the border's value, the others extrapolate. The order is that
// over both halvings: where the patches lie on the border differs from mesh to mesh.
TEST(RadialBasis, ConvergesOnAWavySurfaceWithTheOrderOfTheMethod) {
  for (const Convergence& c :
       {Convergence{"nearest-neighbour", "", 0.9}, Convergence{"nearest-projection", "", 0.9},
        Convergence{"linear-cell", "", 1.8}, Convergence{"radial-basis", "wendland-c2", 1.8},
        Convergence{"radial-basis", "wendland-c4", 1.8}, Convergence{"radial-basis", "wendland-c6", 1.8},
        Convergence{"radial-basis", "thin-plate", 1.8}}) {
    std::vector<double> error;
    double condition = 0;
    for (const int m : {20, 40, 80}) {
      const InterfaceMesh structure = wavy(m), fluid = wavy(m, 0.3);
      MappingParameters parameters = {.kind = c.kind};
      if (!c.function.empty()) parameters.radial_basis.function = c.function;
      const Mapping mapping = make_mapping(parameters, structure, fluid);
      error.push_back(error_of(mapping, structure, fluid));
      condition = mapping.quality().condition;
    }
    const double order = 0.5 * std::log2(error[0] / error[2]);
    std::printf("  %-18s %-12s errors %.2e %.2e %.2e  order %.2f  condition %.1e\n", c.kind.c_str(),
                c.function.c_str(), error[0], error[1], error[2], order, condition);
    EXPECT_GE(order, c.least) << c.kind << " " << c.function;
  }
}

TEST(RadialBasis, ComesAsNearByPatchesAsByOneSystem) {
  const InterfaceMesh structure = wavy(36), fluid = wavy(30, 0.3);
  for (const std::string& function : functions) {
    const Mapping patches = radial_basis(structure, fluid, {.function = function});
    const Mapping global = radial_basis(structure, fluid, {.function = function, .solve = "global"});
    const Field u = {"displacement", "m", false, smooth(structure.position)};
    const double apart = (patches.consistent(u).value - global.consistent(u).value).cwiseAbs().maxCoeff();
    const double by_patches = error_of(patches, structure, fluid),
                 by_one = error_of(global, structure, fluid);
    std::printf("  %-12s patches %.2e, one system %.2e, apart %.2e; conditions %.1e %.1e, row of %.0f\n",
                function.c_str(), by_patches, by_one, apart, patches.quality().condition,
                global.quality().condition, patches.quality().row_size);
    EXPECT_LE(apart, by_patches + by_one) << function;
    EXPECT_LE(by_patches, 3 * by_one + 1e-6) << function;
  }
}

TEST(RadialBasis, IsOneSystemWhereThePointsFitInOnePatch) {
  const InterfaceMesh structure = wavy(6), fluid = wavy(11, 0.3);
  const Mapping patches = radial_basis(structure, fluid, {.patch_points = 49});
  const Mapping global = radial_basis(structure, fluid, {.solve = "global"});
  EXPECT_EQ(patches.quality().patches, 1);
  EXPECT_LE((MatrixXd(patches.weights()) - MatrixXd(global.weights())).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(RadialBasis, SharesTheWeightOfPointsThatCoincide) {
  InterfaceMesh once = wavy(15), twice = once;
  const InterfaceMesh fluid = wavy(12, 0.3);
  const Index n = once.position.cols();
  twice.position.conservativeResize(3, n + 2);
  twice.position.col(n) = once.position.col(3);
  twice.position.col(n + 1) = once.position.col(3);
  const MatrixXd single = radial_basis(once, fluid).weights(), shared = radial_basis(twice, fluid).weights();
  MatrixXd expected = single;
  expected.conservativeResize(Eigen::NoChange, n + 2);
  expected.col(3) /= 3;
  expected.col(n) = expected.col(n + 1) = expected.col(3);
  EXPECT_LE((shared - expected).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(RadialBasis, WorksFromOnePointAndFromTwo) {
  const InterfaceMesh fluid = strip("fluid", 4, 1);
  for (const std::string& function : functions)
    for (const int n : {1, 2}) {
      InterfaceMesh structure = strip("structure", 1, 1);
      structure.position.conservativeResize(3, n);
      structure.faces.resize(2, 0);
      const Mapping mapping = radial_basis(structure, fluid, {.function = function});
      MatrixXd expected(5, n);
      for (Index i = 0; i < 5; ++i)
        if (n == 1)
          expected(i, 0) = 1;
        else
          expected.row(i) << 1 - 0.25 * static_cast<double>(i), 0.25 * static_cast<double>(i);
      EXPECT_LE((MatrixXd(mapping.weights()) - expected).cwiseAbs().maxCoeff(), 1e-14) << function << n;
    }
}

TEST(RadialBasis, IsTheSameToTheBitWithAnyNumberOfThreads) {
  const InterfaceMesh structure = wavy(160), fluid = wavy(165, 0.3);
  const Field u = {"displacement", "m", false, random_values(structure.position.cols(), 1)};
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const Mapping alone = radial_basis(structure, fluid);
  const MatrixXd mapped = alone.consistent(u).value;
  omp_set_num_threads(3);
  const Mapping threads = radial_basis(structure, fluid);
  EXPECT_GT(threads.weights().nonZeros(), 2000000);  // enough for threads in the product
  EXPECT_EQ(threads.consistent(u).value, mapped);
  omp_set_num_threads(before);
}

TEST(RadialBasis, DividesEveryTargetAmongItsPatches) {
  const InterfaceMesh structure = wavy(30), fluid = wavy(23, 0.3);
  const PartitionOfUnity partition =
      divide(structure.position, fluid.position, {.points = 30, .overlap = 0.2});
  EXPECT_GT(partition.patches.size(), 50u);
  std::vector<bool> used(static_cast<std::size_t>(structure.position.cols()));
  for (const Patch& patch : partition.patches) {
    EXPECT_GE(patch.source.size(), 8u);
    EXPECT_LE(patch.source.size(), 60u);
    for (const Index j : patch.source) used[static_cast<std::size_t>(j)] = true;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  for (Index i = 0; i < fluid.position.cols(); ++i) {
    const auto share = shares(partition, i, fluid.position.col(i));
    ASSERT_FALSE(share.empty());
    double sum = 0;
    for (const double s : share) {
      EXPECT_GE(s, 0);
      sum += s;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
  }
  InterfaceMesh far = fluid;
  far.position.row(2).array() += 5;
  EXPECT_EQ(divide(structure.position, far.position, {}).beyond, far.position.cols());
}

// A coarse sheet with a patch a hundred times as dense in its middle. No ball may contain all of that patch.
TEST(RadialBasis, KeepsItsSystemsSmallWhereThePointsAreGraded) {
  const auto graded = [](int coarse, int fine, double shift) {
    InterfaceMesh mesh = wavy(coarse, shift);
    const InterfaceMesh dense = patchwork("dense", fine, [&](double a, double b) -> Vector3d {
      const double x = 0.52 + 0.1 * (a + shift / fine), y = 0.52 + 0.1 * (b + shift / fine);
      return {x, y, 0.1 * std::sin(2 * std::numbers::pi * x) * std::cos(2 * std::numbers::pi * y)};
    });
    mesh.position.conservativeResize(3, mesh.position.cols() + dense.position.cols());
    mesh.position.rightCols(dense.position.cols()) = dense.position;
    return mesh;
  };
  const InterfaceMesh structure = graded(12, 80, 0), fluid = graded(12, 40, 0.3);
  for (const Patch& patch : divide(structure.position, fluid.position, {.points = 30}).patches)
    EXPECT_LE(patch.source.size(), 120u);
  const Mapping mapping = radial_basis(structure, fluid);
  EXPECT_LE(mapping.quality().row_sum_error, 1e-12);
  // Few sources of a thinned ball may be too flat for the linear field across them.
  const Field u = {"displacement", "m", false, linear(structure.position)};
  EXPECT_LE((mapping.consistent(u).value - linear(fluid.position)).cwiseAbs().maxCoeff(), 1e-5);
  // Where the sheet is coarse as near as the coarse sheet alone, where it is dense much nearer.
  const MatrixXd error = (mapping.consistent({"displacement", "m", false, smooth(structure.position)}).value -
                          smooth(fluid.position))
                             .cwiseAbs();
  const double coarse = error_of(radial_basis(wavy(12), fluid), wavy(12), fluid);
  EXPECT_LE(error.leftCols(169).maxCoeff(), 1.1 * coarse);
  EXPECT_LE(error.rightCols(1681).maxCoeff(), 0.1 * coarse);
}

// Points through a volume, without any faces: linear fields and moments as on surfaces.
TEST(RadialBasis, InterpolatesInAVolumeOfPoints) {
  const auto cloud = [](int n, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    return InterfaceMesh{"cloud", 3, Points::NullaryExpr(3, n, [&] { return unit(random); }), {}, {}};
  };
  const InterfaceMesh structure = cloud(3000, 3), fluid = cloud(500, 4);
  const Mapping mapping = make_mapping({.kind = "radial-basis"}, structure, fluid);
  const Field u = {"displacement", "m", false, linear(structure.position)};
  EXPECT_LE((mapping.consistent(u).value - linear(fluid.position)).cwiseAbs().maxCoeff(), 1e-11);
  const Mapping nearest = nearest_neighbour(structure, fluid);
  EXPECT_LE(error_of(mapping, structure, fluid), 0.1 * error_of(nearest, structure, fluid));
}

// φ > 0 inside its support, smooth to zero at its end, and the values of Wendland's table.
TEST(RadialBasis, HasWendlandsFunctions) {
  Eigen::ArrayXd squared(3);
  squared << 0, 1, 4.1;
  for (const auto& [function, half] :
       {std::pair{RadialFunction::wendland_c2, 3.0 / 16}, std::pair{RadialFunction::wendland_c4, 83.0 / 768},
        std::pair{RadialFunction::wendland_c6, 61.0 / 1024}}) {
    const Eigen::ArrayXd value = radial_values(function, 2, squared);
    EXPECT_NEAR(value[0], 1, 1e-15);
    EXPECT_NEAR(value[1], half, 1e-15);
    EXPECT_EQ(value[2], 0);
  }
  const Eigen::ArrayXd plate = radial_values(RadialFunction::thin_plate, 0, squared);
  EXPECT_EQ(plate[0], 0);
  EXPECT_NEAR(plate[2], 4.1 * std::log(std::sqrt(4.1)), 1e-14);
}

TEST(RadialBasis, RefusesWhatCannotBeSolved) {
  const InterfaceMesh structure = wavy(50), small = wavy(12), fluid = wavy(10, 0.3);
  expect_refused([&] { radial_basis(structure, fluid, {.solve = "global"}); },
                 "all 2601 structure points for 121 fluid points is too much");
  expect_refused([&] { radial_basis(small, fluid, {.function = "wendland-c6", .support = 1e4}); },
                 "singular in double precision");
  expect_refused([&] { radial_basis(small, fluid, {.function = "gauss"}); },
                 "\"gauss\" is not a radial basis function");
}

}  // namespace radial_mapping_test
}  // namespace strake
