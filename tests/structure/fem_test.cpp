#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/error.hpp"
#include "structure/fem/grading.hpp"
#include "structure/fem/make_solver.hpp"
#include "structure/fem/solver.hpp"

namespace strake::structure::fem {
namespace {

/// The paper's plate with two cells through the thickness: quick, and as exact in what is tested here as any
/// other.
Parameters plate(Support left, Support right, MaterialModel model) {
  Parameters p;
  p.plate.length = 0.4;
  p.plate.thickness = 0.02;
  p.plate.left = left;
  p.plate.right = right;
  p.material.model = model;
  p.fem.refinement = 1;
  return p;
}

Load uniform_load(const InterfaceMesh& mesh, double time, const Eigen::Vector3d& force) {
  return Load(
      {Sample{time, {{"force", "N", true, Eigen::MatrixXd(force.replicate(1, mesh.position.cols()))}}}});
}

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

double total(const Energy& e) {
  return e.kinetic + e.strain - e.external;
}

constexpr auto both_models = {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff};

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
  const Discretisation<2> d(p.plate, GetParam(), 2);
  const Assembly<2> assembly(d.mesh(), p.material);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(d.mesh().n_unknowns());
  EXPECT_NEAR(ones.dot(assembly.mass() * ones), 2 * 7800 * 0.4 * 0.02, 1e-10) << "once for each direction";
  EXPECT_NEAR(d.mesh().face[0].sum(), 0.02, 1e-15);
  EXPECT_NEAR(d.mesh().face[3].sum(), 0.4, 1e-14);
  EXPECT_NEAR(d.mesh().weight.sum(), 0.4 * 0.02, 1e-15);
}

TEST_P(Cells, ALinearFieldHasItsClosedFormEnergyAndLeavesInnerNodesAtRest) {
  Eigen::Matrix2d H;
  H << 0.03, -0.2, 0.15, -0.05;
  for (const auto model : both_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(p.plate, GetParam(), 2);
    const Assembly<2> assembly(d.mesh(), p.material);
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
  const Discretisation<2> d(p.plate, 2, 1);
  const Assembly<2> assembly(d.mesh(), p.material);
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
  for (const auto model : both_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(p.plate, GetParam(), 1);
    const Assembly<2> assembly(d.mesh(), p.material);
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
  for (const auto model : both_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(p.plate, GetParam(), 1);
    const Assembly<2> assembly(d.mesh(), p.material);
    const Eigen::VectorXd u1 = on_nodes(d.mesh(), bent), u0 = 0.3 * u1;
    const Eigen::VectorXd way = on_nodes(d.mesh(), [](const Eigen::Vector2d& x) {
      return Eigen::Vector2d(std::sin(20 * x.y()), std::cos(9 * x.x()));
    });
    for (const double alpha : {0.0, 0.5}) {
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
  for (const auto model : both_models) {
    Parameters p = plate(Support::free, Support::free, model);
    const Discretisation<2> d(p.plate, 2, 1);
    const Assembly<2> assembly(d.mesh(), p.material);
    const Eigen::VectorXd u1 = on_nodes(d.mesh(), bent);
    const Eigen::VectorXd u0 = on_nodes(
        d.mesh(), [](const Eigen::Vector2d& x) { return Eigen::Vector2d(0.1 * x.y(), -x.x() * x.x()); });
    const double change = assembly.strain_energy(u1) - assembly.strain_energy(u0);
    EXPECT_NEAR(assembly.internal_force(u0, u1, 0.5).dot(u1 - u0) / change, 1, 1e-12);
  }
}

TEST(Assembly, VonMisesOfUniformTensionIsItsClosedForm) {
  Parameters p = plate(Support::free, Support::free, MaterialModel::linear);
  const Discretisation<2> d(p.plate, 2, 1);
  const Assembly<2> assembly(d.mesh(), p.material);
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
  const Discretisation<2> d(p.plate, 2, 1);
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

TEST(FemSolver, AnUnloadedDrivenPlateMovesAsARigidBody) {
  for (const auto model : both_models) {
    Parameters p = plate(Support::clamped, Support::clamped, model);
    p.velocity = {0, -6.26, 0};
    FemSolver<2> solver(p);
    for (int i = 0; i < 50; ++i) solver.advance(i * 1e-5, 1e-5, Load());
    const Points u = solver.displacement(), v = solver.velocity();
    EXPECT_NEAR(u.row(1).minCoeff(), -6.26 * 5e-4, 1e-15);
    EXPECT_NEAR(u.row(1).maxCoeff(), -6.26 * 5e-4, 1e-15);
    EXPECT_DOUBLE_EQ(v.row(1).minCoeff(), -6.26);
    EXPECT_EQ(solver.energy().strain, 0);
    EXPECT_NEAR(solver.energy().kinetic, 0.5 * 62.4 * 6.26 * 6.26, 1e-9);
    EXPECT_FALSE(solver.sends_velocity());
  }
}

TEST(FemSolver, AFreePlateGainsTheImpulseOfItsLoad) {
  Parameters p = plate(Support::free, Support::free, MaterialModel::saint_venant_kirchhoff);
  p.gravity = {0, -9.81, 0};
  p.velocity = {1, 2, 0};
  FemSolver<2> solver(p);
  const double n = static_cast<double>(solver.interface().position.cols());
  double impulse = 0;
  for (int i = 0; i < 20; ++i) {
    solver.advance(i * 1e-4, 1e-4, uniform_load(solver.interface(), 0, {0, 10.0 * i, 0}));
    impulse += 1e-4 * n * 10.0 * i;
  }
  // Momentum = the mean velocity of the mass.
  const Assembly<2> assembly(solver.mesh(), p.material);
  Eigen::VectorXd up = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
  for (int i = 0; i < solver.mesh().n_nodes(); ++i) up(2 * i + 1) = 1;
  const Frame frame = solver.frame();
  Eigen::VectorXd velocity(up.size());
  for (int i = 0; i < solver.mesh().n_nodes(); ++i)
    velocity.segment<2>(2 * i) = frame.point_data[1].value.col(i).head<2>();
  EXPECT_NEAR(up.dot(assembly.mass() * velocity), 62.4 * 2 + impulse - 62.4 * 9.81 * 20e-4, 1e-9 * impulse);
}

TEST(FemSolver, EnergyBalancesToRoundOffUnderLoadGravityAndDrivenSupports) {
  for (const auto model : both_models) {
    Parameters p = plate(Support::clamped, Support::pinned, model);
    p.velocity = {0, -6.26, 0};
    p.gravity = {0, -9.81, 0};
    p.gravity_ramp = 3e-4;
    p.load = {.kind = LoadKind::traction, .value = {2e5, -1e6, 0}, .face = "top", .at = {}, .ramp = 1e-4};
    FemSolver<2> solver(p);
    const double start = total(solver.energy());
    double largest = 0, error = 0;
    for (int i = 0; i < 100; ++i) {
      solver.advance(i * 1e-5, 1e-5, uniform_load(solver.interface(), 0, {0, i < 30 ? 1e5 : 0.0, 0}));
      const Energy e = solver.energy();
      largest = std::max({largest, e.strain, std::abs(e.external)});
      error = std::max(error, std::abs(total(e) - start));
    }
    ASSERT_GT(largest, 1e3);
    EXPECT_LT(error, 1e-9 * largest);  // Newton's tolerance is 1e-10
  }
}

TEST(FemSolver, DampingTakesWhatTheEnergyBalanceSays) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::linear);
  p.damping = {.mass = 100, .stiffness = 1e-6};
  FemSolver<2> solver(p);
  Eigen::VectorXd velocity = Eigen::VectorXd::Ones(solver.mesh().n_unknowns());
  solver.set_unknowns(0 * velocity, velocity);
  const double start = total(solver.energy());
  double mechanical = start;
  for (int i = 0; i < 100; ++i) {
    solver.advance(i * 1e-5, 1e-5, Load());
    const Energy e = solver.energy();
    EXPECT_LT(e.kinetic + e.strain, mechanical) << "each step loses";
    mechanical = e.kinetic + e.strain;
    EXPECT_NEAR(total(e), start, 1e-9 * start);
  }
}

TEST(FemSolver, RestoreThenAdvanceGivesTheSameBits) {
  for (const double rho : {1.0, 0.8}) {
    Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::saint_venant_kirchhoff);
    p.velocity = {0, -6.26, 0};
    p.fem.rho_infinity = rho;
    FemSolver<2> solver(p);
    EXPECT_EQ(solver.sends_velocity(), rho < 1);
    const auto strong = uniform_load(solver.interface(), 0, {0, 2e6, 0});
    const auto other = uniform_load(solver.interface(), 0, {1e6, -4e6, 0});
    for (int i = 0; i < 8; ++i) solver.advance(i * 1e-4, 1e-4, strong);
    EXPECT_GT(solver.factorisations(), 1) << "the load must be strong enough to renew the tangent";
    solver.save();
    solver.advance(8e-4, 1e-4, strong);
    const Points u = solver.displacement(), v = solver.velocity();
    const Energy e = solver.energy();
    // Another load, another step, more than one step: nothing of it may stay.
    solver.restore();
    solver.advance(8e-4, 5e-5, other);
    solver.advance(8.5e-4, 5e-5, other);
    solver.restore();
    solver.advance(8e-4, 1e-4, strong);
    EXPECT_EQ(solver.displacement(), u);
    EXPECT_EQ(solver.velocity(), v);
    EXPECT_EQ(solver.energy().strain, e.strain);
    EXPECT_EQ(solver.energy().external, e.external);
    EXPECT_EQ(solver.steps(), 9);

    // The same through a checkpoint, in a solver that has none of the factors.
    Archive archive;
    solver.write(archive);
    FemSolver<2> resumed(p);
    resumed.read(archive);
    resumed.advance(8e-4, 1e-4, strong);
    EXPECT_EQ(resumed.displacement(), u);
    EXPECT_EQ(resumed.velocity(), v);
    EXPECT_EQ(resumed.energy().external, e.external);
  }
}

TEST(FemSolver, ProbesFollowTheirMaterialPoint) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::saint_venant_kirchhoff);
  p.velocity = {0, -2, 0};
  FemSolver<2> solver(p);
  const Eigen::Vector3d X = solver.interface().position.col(7);
  for (int i = 0; i < 5; ++i)
    solver.advance(i * 1e-5, 1e-5, uniform_load(solver.interface(), 0, {0, 1e5, 0}));
  EXPECT_LT((solver.displacement_at(X) - solver.displacement().col(7)).norm(), 1e-15);
  EXPECT_LT((solver.velocity_at(X) - solver.velocity().col(7)).norm(), 1e-12);
  EXPECT_LT((solver.displacement_at({-0.2, 0.013, 0}) - Eigen::Vector3d(0, -2 * 5e-5, 0)).norm(), 1e-18)
      << "a clamp";
}

TEST(FemSolver, FramesShowQuadrilateralsThatCoverThePlate) {
  for (const int degree : {1, 2}) {
    Parameters p = plate(Support::clamped, Support::free, MaterialModel::linear);
    p.fem.degree = degree;
    const Frame frame = FemSolver<2>(p).frame();
    double area = 0;
    for (Eigen::Index c = 0; c < frame.cells.cols(); ++c) {
      const Eigen::Vector3d a = frame.position.col(frame.cells(2, c)) - frame.position.col(frame.cells(0, c));
      const Eigen::Vector3d b = frame.position.col(frame.cells(3, c)) - frame.position.col(frame.cells(1, c));
      const double cell = 0.5 * a.cross(b).z();
      EXPECT_GT(cell, 0) << "counter-clockwise";
      area += cell;
    }
    EXPECT_NEAR(area, 0.4 * 0.02, 1e-14);
    ASSERT_EQ(frame.point_data.size(), 3U);
    for (const auto& array : frame.point_data) EXPECT_EQ(array.value.cols(), frame.position.cols());
  }
}

TEST(FemSolver, RefusesALoadThatIsNotFinite) {
  const auto solver = make_solver(plate(Support::clamped, Support::clamped, MaterialModel::linear));
  try {
    solver->advance(0, 1e-5, uniform_load(solver->interface(), 0, {0, std::nan(""), 0}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
  }
}

TEST(FemSolver, GivesUpWithAFixWhenTheLoadCrushesThePlate) {
  const auto solver =
      make_solver(plate(Support::clamped, Support::clamped, MaterialModel::saint_venant_kirchhoff));
  try {
    for (int i = 0; i < 3; ++i)
      solver->advance(i * 1e-4, 1e-4, uniform_load(solver->interface(), 0, {3e9, 1e10, 0}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
    EXPECT_FALSE(error.fix().empty());
  }
}

TEST(FemSolver, APinnedEndNeedsANodeAtMidHeight) {
  Parameters p = plate(Support::pinned, Support::pinned, MaterialModel::linear);
  p.fem.degree = 1;
  p.fem.refinement = 0;
  try {
    make_solver(p);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_NE(error.fix().find("refinement"), std::string::npos);
  }
}

TEST(FemSolver, RefusesTheCheckpointOfAnotherMesh) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::linear);
  Archive archive;
  make_solver(p)->write(archive);
  p.fem.refinement = 2;
  EXPECT_THROW(make_solver(p)->read(archive), Error);
}

}  // namespace
}  // namespace strake::structure::fem
