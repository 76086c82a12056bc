#include "structure/fem/assembly.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "structure/fem/grading.hpp"
#include "tests/structure/fem_plate.hpp"

namespace strake::structure::fem {
namespace {

/// Values of a smooth field of the reference position in the nodes.
template <class Function>
Eigen::VectorXd on_nodes(const Mesh<2>& mesh, const Function& field) {
  Eigen::VectorXd u(mesh.n_unknowns());
  for (int i = 0; i < mesh.n_nodes(); ++i) u.segment<2>(2 * i) = field(Eigen::Vector2d(mesh.node.col(i)));
  return u;
}

/// A bent and stretched shape with strains of some 10 %.
Eigen::Vector2d bent(const Eigen::Vector2d& x) {
  return {0.05 * x.x() - 8 * x.x() * x.y() + 0.1 * x.y(), 4 * x.x() * x.x() - 0.08 * x.y()};
}

class Cells : public testing::TestWithParam<int> {};  // by degree
INSTANTIATE_TEST_SUITE_P(Degrees, Cells, testing::Values(1, 2));

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
  const Discretisation<2> d(elastic_solid(p), GetParam(), 2);
  const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
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
    const Discretisation<2> d(elastic_solid(p), GetParam(), 2);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
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

TEST_P(Cells, TheInternalForceIsTheGradientOfTheStrainEnergy) {
  for (const auto model : all_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam(), 1);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
    const Eigen::VectorXd u = on_nodes(d.mesh(), bent);
    const Eigen::VectorXd way = on_nodes(d.mesh(), [](const Eigen::Vector2d& x) {
      return Eigen::Vector2d(std::sin(20 * x.y()), std::cos(9 * x.x()));
    });
    constexpr double h = 1e-5;  // the central difference of a quartic errs by h² of the third derivative
    const double slope =
        (assembly.strain_energy(u + h * way) - assembly.strain_energy(u - h * way)) / (2 * h);
    EXPECT_NEAR(assembly.internal_force(u, u, 0).dot(way) / slope, 1, 1e-6);
  }
}

TEST_P(Cells, TheTangentIsTheDerivativeOfTheInternalForce) {
  for (const auto model : all_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), GetParam(), 1);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
    const Eigen::VectorXd u1 = on_nodes(d.mesh(), bent), u0 = 0.3 * u1;
    const Eigen::VectorXd way = on_nodes(d.mesh(), [](const Eigen::Vector2d& x) {
      return Eigen::Vector2d(std::sin(20 * x.y()), std::cos(9 * x.x()));
    });
    for (const double alpha : {0.0, 0.5}) {
      if (model == MaterialModel::neo_hookean && alpha == 0.5) continue;  // a term of third order is left out
      constexpr double h = 1e-5;
      const Eigen::VectorXd slope = (assembly.internal_force(u0, u1 + h * way, alpha) -
                                     assembly.internal_force(u0, u1 - h * way, alpha)) /
                                    (2 * h);
      const Eigen::VectorXd tangent = (1 - alpha) * (assembly.tangent(u0, u1, alpha) * way);
      EXPECT_LT((tangent - slope).norm(), 1e-6 * slope.norm());
    }
  }
}

TEST(Assembly, TheMidPointForceWorksExactlyTheChangeOfStrainEnergy) {
  for (const auto model : all_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(elastic_solid(p), 2, 1);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
    const Eigen::VectorXd u1 = on_nodes(d.mesh(), bent);
    const Eigen::VectorXd u0 = on_nodes(
        d.mesh(), [](const Eigen::Vector2d& x) { return Eigen::Vector2d(0.1 * x.y(), -x.x() * x.x()); });
    const double change = assembly.strain_energy(u1) - assembly.strain_energy(u0);
    // Where strains change by 1e-3 and less, neo-Hookean leaves 1e-4 of a term of third order out as
    // round-off.
    const double gate = model == MaterialModel::neo_hookean ? 1e-8 : 1e-12;
    EXPECT_NEAR(assembly.internal_force(u0, u1, 0.5).dot(u1 - u0) / change, 1, gate);
  }
}

TEST(Assembly, VonMisesOfUniformTensionIsItsClosedForm) {
  Parameters p = plate(Support::free, Support::free, MaterialModel::linear);
  const Discretisation<2> d(elastic_solid(p), 2, 1);
  const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
  const Eigen::VectorXd u =
      on_nodes(d.mesh(), [](const Eigen::Vector2d& x) { return Eigen::Vector2d(1e-4 * x.x(), 0); });
  // One strain alone: σ = λε 1 + 2με e⊗e, whose deviator has the von Mises stress 2με.
  const Eigen::VectorXd stress = assembly.von_mises(u);
  EXPECT_NEAR(stress.minCoeff() / (2e-4 * p.material.lame_mu()), 1, 1e-9);
  EXPECT_NEAR(stress.maxCoeff() / (2e-4 * p.material.lame_mu()), 1, 1e-9);
}

TEST(Transfer, KeepsWorkTotalForceAndMoment) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::linear);
  const FemSolver<2> solver(p);
  const Discretisation<2> d(elastic_solid(p), 2, 1);
  const InterfaceMesh& mesh = solver.interface();
  const Transfer<2> transfer(d, mesh.position);
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

}  // namespace
}  // namespace strake::structure::fem
