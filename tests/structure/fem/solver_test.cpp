#include "structure/fem/solver.hpp"

#include "proto/error.hpp"
#include "structure/fem/fem.hpp"
#include "tests/structure/fem/plate.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure::fem {
namespace solver_test {

Load uniform_load(const InterfaceMesh& mesh, double time, const Eigen::Vector3d& force) {
  return Load(
      {Sample{time, {{"force", "N", true, Eigen::MatrixXd(force.replicate(1, mesh.position.cols()))}}}});
}

double total(const Energy& e) {
  return e.kinetic + e.strain - e.external;
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
  const Assembly<2> assembly(solver.mesh(), elastic_solid(p).parts);
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

// A free plate that drag by mass alone slows down, v = exp(−a_M t), of second order in the step: its
// acceleration at t = 0 is that of the drag.
TEST(FemSolver, DampingOfAMovingBodyBeginsWithItsFirstStep) {
  for (const double rho : {1.0, 0.8, 0.5}) {
    Parameters p = plate(Support::free, Support::free, MaterialModel::linear);
    p.damping.mass = 200;
    p.initial.value = {0, 1, 0};
    p.fem.rho_infinity = rho;
    const auto error = [&](int steps) {
      FemSolver<2> solver(p);
      const double dt = 0.01 / steps;
      for (int i = 0; i < steps; ++i) solver.advance(i * dt, dt, Load());
      return std::abs(solver.velocity_at({0, 0, 0}).y() - std::exp(-2.0));
    };
    EXPECT_LT(error(40), 1e-4) << rho;
    EXPECT_GT(error(20), 3.5 * error(40)) << rho;
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
    ASSERT_EQ(frame.point_data.size(), 5U);
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

}  // namespace solver_test
}  // namespace strake::structure::fem
