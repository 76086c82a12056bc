#include "structure/fem/element/assembly.hpp"

#include "structure/fem/mesh/refinement.hpp"
#include "tests/structure/body/boxes.hpp"
#include "tests/structure/fem/plate.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

namespace strake::structure::fem {
namespace assembly_test {

/// Values of a smooth field of the reference position in the nodes.
template <class Function>
Eigen::VectorXd on_nodes(const Mesh<2>& mesh, const Function& field) {
  Eigen::VectorXd u(mesh.n_unknowns());
  for (int i = 0; i < mesh.n_nodes(); ++i) u.segment<2>(2 * i) = field(Eigen::Vector2d(mesh.node.col(i)));
  return u;
}

struct Kind {
  int degree;
  StrainField strain;
};
void PrintTo(const Kind& kind, std::ostream* out) {
  *out << "Q" << kind.degree << (kind.strain == StrainField::enhanced ? " enhanced" : " compatible");
}

/// A bent and stretched shape: strains of some 10 % in the middle, the area doubled at the ends. That is more
/// than enhanced neo-Hookean cells are for, whose minimum of the energy is beside a saddle there.
Eigen::Vector2d bent(const Eigen::Vector2d& x) {
  return {0.05 * x.x() - 8 * x.x() * x.y() + 0.1 * x.y(), 4 * x.x() * x.x() - 0.08 * x.y()};
}

constexpr bool is_enhanced_rubber(const Kind& kind, MaterialModel model) {
  return kind.strain == StrainField::enhanced && model == MaterialModel::neo_hookean;
}

class Cells : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Cells,
                         testing::Values(Kind{1, StrainField::compatible}, Kind{1, StrainField::enhanced},
                                         Kind{2, StrainField::compatible}, Kind{2, StrainField::enhanced}));

TEST(Grading, FillsTheLengthSymmetricallyAndGrowsAwayFromTheEnds) {
  const auto sizes =
      graded_cells(0.4, {.smallest = 0.001, .largest = 0.01, .growth = 0.25, .left = true, .right = true});
  double length = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    length += sizes[i];
    EXPECT_DOUBLE_EQ(sizes[i], sizes[sizes.size() - 1 - i]);
    if (i > 0 && i < sizes.size() / 2) {
      EXPECT_GE(sizes[i], sizes[i - 1] * (1 - 1e-9));
      EXPECT_LE(sizes[i], sizes[i - 1] * 1.3) << "growth 0.25 per length is e^0.25 from cell to cell";
    }
  }
  EXPECT_NEAR(length, 0.4, 1e-15);
  EXPECT_EQ(sizes.size() % 2, 0U) << "the middle of the plate is a vertex";
}

TEST(Grading, OneGradedEndMirrorsTheOther) {
  const Grading left{.smallest = 0.001, .largest = 0.01, .growth = 0.3, .left = true};
  Grading right = left;
  std::swap(right.left, right.right);
  const auto a = graded_cells(0.2, left), b = graded_cells(0.2, right);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_LT(a.front(), a.back());
  EXPECT_DOUBLE_EQ(a.front(), b.back());
}

TEST_P(Cells, MassAndFacesAddUpToThePlate) {
  Parameters p = plate(Support::clamped, Support::free, MaterialModel::linear);
  const Discretisation<2> d(elastic_solid(p), GetParam().degree, 2);
  const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts, GetParam().strain);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(d.mesh().n_unknowns());
  EXPECT_NEAR(ones.dot(assembly.mass() * ones), 2 * 7800 * 0.4 * 0.02, 1e-10) << "once for each direction";
  EXPECT_NEAR(d.face_sizes(facets_named(elastic_solid(p), "left")).sum(), 0.02, 1e-15);
  EXPECT_NEAR(d.face_sizes(facets_named(elastic_solid(p), "top")).sum(), 0.4, 1e-14);
  EXPECT_NEAR(d.mesh().weight.sum(), 0.4 * 0.02, 1e-15);
}

TEST_P(Cells, ALinearFieldHasItsClosedFormEnergyAndLeavesInnerNodesAtRest) {
  Eigen::Matrix2d H;
  H << 0.03, -0.2, 0.15, -0.05;
  for (const auto model : both_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam().degree, 2);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts, GetParam().strain);
    const Eigen::VectorXd u =
        on_nodes(d.mesh(), [&](const Eigen::Vector2d& x) -> Eigen::Vector2d { return H * x; });
    Eigen::Matrix2d E = 0.5 * (H + H.transpose());
    if (model == MaterialModel::saint_venant_kirchhoff) E += 0.5 * H.transpose() * H;
    const double density =
        0.5 * p.material.lame_lambda() * E.trace() * E.trace() + p.material.lame_mu() * E.squaredNorm();
    EXPECT_NEAR(assembly.strain_energy(u) / (density * 0.4 * 0.02), 1, 1e-11);

    const Eigen::VectorXd force = assembly.internal_force(u, u, 0);
    double inside = 0;
    for (int i = 0; i < d.mesh().n_nodes(); ++i) {
      const bool on_boundary = std::abs(std::abs(d.mesh().node(0, i)) - 0.2) < 1e-9 ||
                               std::abs(std::abs(d.mesh().node(1, i) - 0.01) - 0.01) < 1e-9;
      if (!on_boundary) inside = std::max(inside, force.segment<2>(2 * i).norm());
    }
    EXPECT_LT(inside, 1e-11 * force.norm());
  }
}

TEST(Assembly, ARotationOfAnyAngleStoresNothingInSaintVenantKirchhoff) {
  Parameters p = plate(Support::free, Support::free, MaterialModel::saint_venant_kirchhoff);
  const Discretisation<2> d(elastic_solid(p), 2, 1);
  const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
  for (const double angle : {0.3, 1.9, 3.1}) {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix() - Eigen::Matrix2d::Identity();
    const Eigen::VectorXd u =
        on_nodes(d.mesh(), [&](const Eigen::Vector2d& x) -> Eigen::Vector2d { return turn * x; });
    // Strains are exact to round-off ε, and the energy is their square.
    EXPECT_LT(assembly.strain_energy(u), 1e-24 * 2.1e11 * 0.008);
    EXPECT_NEAR(assembly.smallest_jacobian(u), 1, 1e-12);
  }
}

Assembly<2> assembly_of(const Discretisation<2>& d, const Parameters& p, const Kind& kind) {
  return {d.mesh(), elastic_solid(p).parts, kind.strain};
}

Eigen::VectorXd some_way(const Mesh<2>& mesh) {
  return on_nodes(mesh, [](const Eigen::Vector2d& x) {
    return Eigen::Vector2d(std::sin(20 * x.y()), std::cos(9 * x.x()));
  });
}

void force_is_the_gradient(const Assembly<2>& assembly, const Mesh<2>& mesh, const Eigen::VectorXd& u) {
  const Eigen::VectorXd way = some_way(mesh);
  constexpr double h = 1e-5;  // the central difference of a quartic errs by h² of the third derivative
  const double slope = (assembly.strain_energy(u + h * way) - assembly.strain_energy(u - h * way)) / (2 * h);
  EXPECT_NEAR(assembly.internal_force(u, u, 0).dot(way) / slope, 1, 1e-6);
}

void tangent_is_the_derivative(const Assembly<2>& assembly, const Mesh<2>& mesh, MaterialModel model,
                               const Eigen::VectorXd& u1, bool enhanced) {
  const Eigen::VectorXd u0 = 0.3 * u1, way = some_way(mesh);
  for (const double alpha : {0.0, 0.5}) {
    // With added strains a term of third order is left out.
    if (model == MaterialModel::neo_hookean && alpha == 0.5 && enhanced) continue;
    constexpr double h = 1e-5;
    const Eigen::VectorXd slope = (assembly.internal_force(u0, u1 + h * way, alpha) -
                                   assembly.internal_force(u0, u1 - h * way, alpha)) /
                                  (2 * h);
    const Eigen::VectorXd tangent = (1 - alpha) * (assembly.tangent(u0, u1, alpha) * way);
    EXPECT_LT((tangent - slope).norm(), 1e-6 * slope.norm());
  }
}

void work_is_the_change_of_energy(const Assembly<2>& assembly, const Mesh<2>& mesh, const Eigen::VectorXd& u1,
                                  double gate) {
  const Eigen::VectorXd u0 =
      on_nodes(mesh, [](const Eigen::Vector2d& x) { return Eigen::Vector2d(0.1 * x.y(), -x.x() * x.x()); });
  const double change = assembly.strain_energy(u1) - assembly.strain_energy(u0);
  EXPECT_NEAR(assembly.internal_force(u0, u1, 0.5).dot(u1 - u0) / change, 1, gate);
}

TEST_P(Cells, TheInternalForceIsTheGradientOfTheStrainEnergy) {
  for (const auto model : all_models) {
    if (is_enhanced_rubber(GetParam(), model)) continue;
    const Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam().degree, 1);
    force_is_the_gradient(assembly_of(d, p, GetParam()), d.mesh(), on_nodes(d.mesh(), bent));
  }
}

TEST_P(Cells, TheTangentIsTheDerivativeOfTheInternalForce) {
  for (const auto model : all_models) {
    if (is_enhanced_rubber(GetParam(), model)) continue;
    const Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam().degree, 1);
    tangent_is_the_derivative(assembly_of(d, p, GetParam()), d.mesh(), model, on_nodes(d.mesh(), bent),
                              GetParam().strain == StrainField::enhanced);
  }
}

TEST_P(Cells, TheMidPointForceWorksExactlyTheChangeOfStrainEnergy) {
  for (const auto model : all_models) {
    if (is_enhanced_rubber(GetParam(), model)) continue;
    const Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam().degree, 1);
    work_is_the_change_of_energy(assembly_of(d, p, GetParam()), d.mesh(), on_nodes(d.mesh(), bent), 1e-12);
  }
}

// All three, to an area that grows by a half.
TEST(EnhancedNeoHookean, ForcesTangentAndWorkAreThoseOfItsEnergy) {
  constexpr auto model = MaterialModel::neo_hookean;
  for (const int degree : {1, 2}) {
    const Kind kind{degree, StrainField::enhanced};
    const Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), degree, 1);
    const Assembly<2> assembly = assembly_of(d, p, kind);
    const Eigen::VectorXd u = 0.5 * on_nodes(d.mesh(), bent);
    force_is_the_gradient(assembly, d.mesh(), u);
    tangent_is_the_derivative(assembly, d.mesh(), model, u, true);
    // Where strains change by 1e-3 and less, 1e-4 of a term of third order is left out as round-off.
    work_is_the_change_of_energy(assembly, d.mesh(), u, 1e-8);
  }
}

TEST(Assembly, AutomaticStrainsAreEnhancedWhereCellsLockUnlessNeoHookean) {
  const auto enhanced = [](int degree, double poisson, MaterialModel model) {
    Parameters p = plate(Support::free, Support::free, model);
    p.material.poisson = poisson;
    const Discretisation<2> d(elastic_solid(p), degree, 0);
    return Assembly<2>(d.mesh(), elastic_solid(p).parts).any_enhanced();
  };
  EXPECT_TRUE(enhanced(1, 0.3, MaterialModel::linear));
  EXPECT_TRUE(enhanced(1, 0.3, MaterialModel::saint_venant_kirchhoff));
  EXPECT_FALSE(enhanced(2, 0.48, MaterialModel::saint_venant_kirchhoff));
  EXPECT_TRUE(enhanced(2, 0.49, MaterialModel::saint_venant_kirchhoff));
  EXPECT_FALSE(enhanced(1, 0.3, MaterialModel::neo_hookean));
  EXPECT_FALSE(enhanced(2, 0.499, MaterialModel::neo_hookean));
}

// Of a body whose cells are handed to threads, with the mesh made anew for each number of them.
TEST(Assembly, SumsHaveTheSameBitsForAnyNumberOfThreads) {
  for (const StrainField strain : {StrainField::enhanced, StrainField::solid_shell}) {
    const Solid solid = solid_of_boxes(
        3, {box("plate", {0, 0, 0}, {2, 0.02, 2}, {.model = MaterialModel::saint_venant_kirchhoff})});
    std::vector<Eigen::VectorXd> first;
    for (const int threads : {1, 2, 3}) {
      use_threads(threads);
      const Discretisation<3> d(solid, 1, 0, 0.04);
      const Mesh<3>& mesh = d.mesh();
      ASSERT_GE(mesh.n_cells(), 2000);
      const Assembly<3> assembly(mesh, solid.parts, strain);
      Eigen::VectorXd u(mesh.n_unknowns());
      for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = 1e-3 * std::sin(0.37 * static_cast<double>(i));
      const std::vector<Eigen::VectorXd> sums = {
          mesh.gradient.reshaped(), assembly.mass().coeffs(), assembly.tangent(u).coeffs(),
          assembly.internal_force(0.5 * u, u, 0.5), Eigen::VectorXd::Constant(1, assembly.strain_energy(u))};
      if (first.empty()) first = sums;
      for (std::size_t k = 0; k < sums.size(); ++k) EXPECT_EQ(sums[k], first[k]) << threads << " " << k;
    }
  }
  use_threads(1);
}

TEST(Transfer, KeepsWorkTotalForceAndMoment) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::linear);
  const FemSolver<2> solver(p);
  const Discretisation<2> d(elastic_solid(p), 2, 1);
  const InterfaceMesh& mesh = solver.interface();
  const PointInterpolation<2> transfer(d, mesh.position);
  const Eigen::Index n = mesh.position.cols();
  Points force = Points::Random(3, n);
  force.row(2).setZero();
  const Eigen::VectorXd u = Eigen::VectorXd::Random(d.mesh().n_unknowns());
  const Eigen::VectorXd on_unknowns = transfer.to_unknowns(force);
  const double work = force.cwiseProduct(transfer.at_points(u)).sum();
  EXPECT_NEAR(on_unknowns.dot(u), work, 1e-12 * on_unknowns.norm() * u.norm());

  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double moment = 0, wanted = 0;
  for (int i = 0; i < d.mesh().n_nodes(); ++i) {
    const Eigen::Vector2d f = on_unknowns.segment<2>(2 * i), x = d.mesh().node.col(i);
    sum += f;
    moment += x.x() * f.y() - x.y() * f.x();
  }
  for (Eigen::Index i = 0; i < n; ++i)
    wanted += mesh.position(0, i) * force(1, i) - mesh.position(1, i) * force(0, i);
  EXPECT_LT((sum - force.topRows<2>().rowwise().sum()).norm(), 1e-12 * force.norm());
  EXPECT_NEAR(moment, wanted, 1e-12 * force.norm());
}

}  // namespace assembly_test
}  // namespace strake::structure::fem
