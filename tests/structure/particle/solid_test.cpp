// Particles in three dimensions: the same promises as in the plane.
#include "structure/body/surface.hpp"
#include "structure/material/symmetric.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/solver.hpp"
#include "structure/particle/total_lagrangian.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace strake::structure {
namespace particle_solid_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double d = 0.005;  // [m]

Parameters bar(double length, double width, Support left) {
  Parameters p;
  p.kind = "particle";
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  SolidBox box;
  box.name = "bar";
  box.min << 0, 0, 0;
  box.max << length, width, width;
  box.support[0] = left;
  p.solid = solid_of_boxes(3, {box});
  p.particle.spacing = p.surface_spacing = d;
  return p;
}

/// A free block of 5 × 4 × 4 particles of steel.
struct Block {
  Lattice<3> lattice = make_lattice<3>(bar(5 * d, 4 * d, Support::free).solid, d, 2.1);
  Bonds<3> bonds = make_bonds<3>(lattice, 2.1);
  TotalLagrangian<3> elastic{lattice, bonds, 1.0};

  Vectors<3> random(double size) const {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-size, size);
    return Vectors<3>::NullaryExpr(3, lattice.size(), [&] { return uniform(generator); });
  }
};

Vector3d torque(const Vectors<3>& x, const Vectors<3>& f) {
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) sum += Vector3d(x.col(i)).cross(Vector3d(f.col(i)));
  return sum;
}

TEST(ParticleSolid, DisplacementGradientIsExactForLinearFieldsEvenAtCorners) {
  const Block block;
  Matrix3d F;
  F << 1.01, 0.2, 0.05, -0.3, 0.9, 0.1, 0.02, -0.04, 1.1;
  const Tensors<3> H =
      displacement_gradient<3>(block.bonds, (F - Matrix3d::Identity()) * block.lattice.position);
  for (Eigen::Index i = 0; i < H.cols(); ++i)
    EXPECT_LT((Eigen::Map<const Matrix3d>(H.col(i).data()) + Matrix3d::Identity() - F).norm(), 1e-12);
}

TEST(ParticleSolid, LinearAndAngularMomentumAreKeptUnderAnyDeformation) {
  const Block block;
  const Vectors<3> u = block.random(0.2 * d), f = block.elastic.force(u);
  const double size = f.cwiseAbs().sum();
  EXPECT_LT(f.rowwise().sum().norm(), 1e-13 * size);
  EXPECT_LT(torque(block.lattice.position + u, f).norm(), 1e-13 * size * 0.03);  // arm: the block's size
}

TEST(ParticleSolid, ForceIsTheNegativeGradientOfTheEnergy) {
  const Block block;
  const Vectors<3> u = block.random(0.1 * d), f = block.elastic.force(u);
  const double step = 1e-5 * d;  // as in the plane
  for (const Eigen::Index i : {0, 17, 42, 79})
    for (int axis = 0; axis < 3; ++axis) {
      Vectors<3> plus = u, minus = u;
      plus(axis, i) += step;
      minus(axis, i) -= step;
      const double gradient = (block.elastic.energy(plus) - block.elastic.energy(minus)) / (2 * step);
      EXPECT_NEAR(f(axis, i), -gradient, 1e-7 * f.cwiseAbs().maxCoeff());
    }
}

TEST(ParticleSolid, ABodyTurnedByThirtyDegreesAboutAnyAxisIsAtRest) {
  const Block block;
  const Matrix3d R = Eigen::AngleAxisd(std::acos(-1.0) / 6, Vector3d(1, 2, -3).normalized()).matrix();
  const Vectors<3> u = (R - Matrix3d::Identity()) * block.lattice.position;
  const Tensors<3> H = displacement_gradient<3>(block.bonds, u);
  const Material steel;
  for (Eigen::Index i = 0; i < H.cols(); ++i) {
    const Matrix3d F = Matrix3d::Identity() + Eigen::Map<const Matrix3d>(H.col(i).data());
    EXPECT_LT(first_piola_kirchhoff<3>(steel, F).norm(), 1e-10 * steel.young);
  }
  EXPECT_LT(block.elastic.force(u).cwiseAbs().maxCoeff(), 1e-11 * steel.young * d * d);
}

TEST(ParticleSolid, ElasticLimitIsThatOfTheLargestEigenvalue) {
  const auto lattice = make_lattice<3>(bar(5 * d, 4 * d, Support::clamped).solid, d, 2.1);
  const auto bonds = make_bonds<3>(lattice, 2.1);
  const TotalLagrangian<3> elastic(lattice, bonds, 1.0);
  const double mass = 7800 * d * d * d;
  const Eigen::MatrixXd K = stiffness<3>(elastic, lattice, Vectors<3>::Zero(3, lattice.size()));
  EXPECT_LT((K - K.transpose()).norm(), 1e-9 * K.norm());
  const double omega2 = eigenvalues_of(K / mass).maxCoeff();
  const double limit = elastic_limit<3>(elastic, lattice, Eigen::VectorXd::Constant(lattice.size(), mass));
  EXPECT_NEAR(limit / (2 / std::sqrt(omega2)), 1.01, 0.0101);
}

TEST(ParticleSolid, AFreeBlockTakesForceMomentAndWorkFromItsSurface) {
  Parameters p = bar(6 * d, 4 * d, Support::free);
  p.surface_spacing = 0.7 * d;
  ParticleSolver<3> solver(p);
  const InterfaceMesh& mesh = solver.interface();
  ASSERT_EQ(mesh.faces.rows(), 3);
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, mesh.position.cols());
  for (Eigen::Index i = 0; i < force.cols(); ++i) {
    const Vector3d X = mesh.position.col(i);
    force.col(i) << 3 + X.y() / d, 1 - X.z() / d, 2 + X.x() / d;
  }
  const Load load({{0, {{"force", "N", true, force}}}});
  const double dt = solver.stable_dt();
  solver.advance(0, dt, load);
  const Vector3d momentum = solver.momentum(), expected = dt * force.rowwise().sum();
  EXPECT_LT((momentum - expected).norm(), 1e-12 * expected.norm());
  Vector3d moment = Vector3d::Zero();
  for (Eigen::Index i = 0; i < force.cols(); ++i)
    moment += dt * Vector3d(mesh.position.col(i)).cross(Vector3d(force.col(i)));
  // The places at which the second half of the kick acts have moved on by some 1e-9 spacings.
  EXPECT_LT((solver.angular_momentum() - moment).norm(), 1e-7 * moment.norm());
  EXPECT_NEAR(solver.energy().external / force.cwiseProduct(solver.displacement()).sum(), 1, 1e-12);
}

TEST(ParticleSolid, CheckpointAndRewindAreBitEqual) {
  Parameters p = bar(6 * d, 4 * d, Support::clamped);
  p.gravity = {0, -9.81, 0};
  p.velocity = {0, -1, 0.5};
  ParticleSolver<3> first(p), second(p);
  Vectors<3> v = first.lattice().position;
  first.set_velocity(v);
  first.advance(0, 1e-5, {});
  first.save();
  Archive archive;
  first.write(archive);
  second.read(archive);
  first.advance(1e-5, 1e-5, {});
  const Points once = first.displacement();
  first.restore();
  first.advance(1e-5, 1e-5, {});
  second.advance(1e-5, 1e-5, {});
  EXPECT_EQ(first.displacement(), once);
  EXPECT_EQ(second.displacement(), once);
  EXPECT_EQ(first.frame().point_data.at(2).value.rows(), 6);
}

/// A bar of boxes whose sides are supported as given: left, right, bottom, top, back, front.
Parameters held_bar(const std::array<Support, 6>& support) {
  Parameters p = bar(12 * d, 4 * d, Support::free);
  SolidBox box;
  box.name = "bar";
  box.max << 12 * d, 4 * d, 4 * d;
  box.support = support;
  p.solid = solid_of_boxes(3, {box});
  p.gravity = {0, -1000, 0};
  return p;
}

// Pinned on the line at mid-height of an end, a roller at the other, symmetric at the back. The lines stay,
// and the bar's end faces turn about them.
TEST(ParticleSolid, SupportsHoldTheirLinesAndPlanes) {
  ParticleSolver<3> solver(held_bar(
      {Support::pinned, Support::roller, Support::free, Support::free, Support::symmetry, Support::free}));
  solver.solve_static();
  const auto u = [&](double x, double y, double z) -> Vector3d {
    return solver.displacement_at(Vector3d(x, y, z) * d);
  };
  const double sag = -u(6, 2, 2).y();
  ASSERT_GT(sag, 0);
  const double nothing = 1e-8 * sag;
  for (const double z : {0.5, 2.5}) {
    EXPECT_LT(u(0, 2, z).norm(), nothing);
    EXPECT_LT(std::abs(u(12, 2, z).y()), nothing);
    EXPECT_LT(std::abs(u(12, 2, z).z()), nothing + 0.05 * sag) << "free but for the other supports";
  }
  for (const double x : {0.5, 5.5, 11.5}) EXPECT_LT(std::abs(u(x, 2.5, 0).z()), nothing);
  EXPECT_GT(std::abs(u(0, 4, 2).x()), 0.01 * sag) << "it turns";
}

TEST(ParticleSolid, AClampedBarAndItsFreeFrameKeepTheirMomentum) {
  Parameters p = held_bar(
      {Support::clamped, Support::pinned, Support::free, Support::free, Support::free, Support::free});
  p.free.x = p.free.y = p.free.z = true;
  p.body.lumped_mass = 0.5;
  p.velocity = {1, 0, -2};
  p.damping.mass = 100;
  ParticleSolver<3> solver(p);
  const double mass = 0.5 + 7800 * 12 * 16 * d * d * d, dt = 1e-5;
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, solver.interface().position.cols());
  force.row(1).setConstant(40);
  force.row(2).setConstant(-10);
  const Load load({{0, {{"force", "N", true, force}}}});
  for (int k = 0; k < 20; ++k) solver.advance(k * dt, dt, load);
  const Vector3d expected = mass * p.velocity + 20 * dt * (force.rowwise().sum() + mass * p.gravity);
  EXPECT_LT((solver.momentum() - expected).norm(), 1e-12 * expected.norm());
}

}  // namespace particle_solid_test
}  // namespace strake::structure
