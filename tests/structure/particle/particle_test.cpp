#include "structure/material/material.hpp"
#include "structure/material/symmetric.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/pair_model.hpp"
#include "structure/particle/total_lagrangian.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <random>

namespace strake::structure {
namespace particle_test {

Lattice<2> lattice_of(const Plate& plate, double spacing, ClampColumn clamp = ClampColumn::inside,
                      const Material& material = {}) {
  Parameters p;
  p.plate = plate;
  p.material = material;
  return make_lattice<2>(elastic_solid(p), spacing, 2.1, clamp);
}

/// A free 12 × 4 block of steel.
struct Block {
  explicit Block(ParticleModel model, MaterialModel material_model = MaterialModel::saint_venant_kirchhoff) {
    material.model = material_model;
    lattice = lattice_of({.length = 12 * spacing, .thickness = 4 * spacing}, spacing, ClampColumn::inside,
                         material);
    bonds = make_bonds<2>(lattice, 2.1);
    if (model == ParticleModel::pair)
      elastic = std::make_unique<PairModel>(lattice, bonds);
    else
      elastic = std::make_unique<TotalLagrangian<2>>(lattice, bonds, 1.0);
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  static constexpr double spacing = 0.005;  // [m]
  Material material;
  Lattice<2> lattice;
  Bonds<2> bonds;
  std::unique_ptr<ElasticModel<2>> elastic;

  Eigen::Matrix2Xd random(double size) const {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(-size, size);
    return Eigen::Matrix2Xd::NullaryExpr(2, lattice.size(), [&] { return uniform(generator); });
  }
  /// u = (F − 1) X
  Eigen::Matrix2Xd uniform(const Eigen::Matrix2d& F) const {
    return (F - Eigen::Matrix2d::Identity()) * lattice.position;
  }
};

double torque(const Eigen::Matrix2Xd& x, const Eigen::Matrix2Xd& f) {
  return x.row(0).cwiseProduct(f.row(1)).sum() - x.row(1).cwiseProduct(f.row(0)).sum();
}

TEST(Bonds, FullLatticeHasTheNumberDensityOfTheTable) {
  const Block block(ParticleModel::pair);
  EXPECT_NEAR(block.bonds.n0, 6.539697, 1e-6);  // fluid/THEORY.md (F15), r_e = 2.1
}

TEST(Bonds, DisplacementGradientIsExactForLinearFieldsEvenAtCorners) {
  const Block block(ParticleModel::total_lagrangian);
  Eigen::Matrix2d F;
  F << 1.01, 0.2, -0.3, 0.9;
  const Eigen::Matrix4Xd H = displacement_gradient<2>(block.bonds, block.uniform(F));
  for (Eigen::Index i = 0; i < H.cols(); ++i)
    EXPECT_LT((Eigen::Map<const Eigen::Matrix2d>(H.col(i).data()) + Eigen::Matrix2d::Identity() - F).norm(),
              1e-13);
}

TEST(Lattice, InterpolationKeepsLinearFieldsForceAndMoment) {
  const Block block(ParticleModel::pair);
  const Points at{{-0.03, -0.03, 0.03, 0.0071, 0.0}, {0.0, 0.02, 0.02, 0.013, 0.0}, {0, 0, 0, 0, 0}};
  const auto N = interpolation<2>(block.lattice, at);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(block.lattice.size());
  EXPECT_LT((N * ones - Eigen::VectorXd::Ones(at.cols())).norm(), 1e-14);
  EXPECT_LT((N * block.lattice.position.transpose() - at.topRows<2>().transpose()).norm(), 1e-15);
  // The transpose then keeps sum and moment of any force: Σ_i x_i × (Nᵀf)_i = Σ_p (N x)_p × f_p.
  const Eigen::Matrix2Xd f{{1, -2, 3, 4, 0.5}, {-1, 5, 2, 0.3, 7}};
  const Eigen::Matrix2Xd on_particles = (N.transpose() * f.transpose()).transpose();
  EXPECT_LT((on_particles.rowwise().sum() - f.rowwise().sum()).norm(), 1e-13);
  EXPECT_NEAR(torque(block.lattice.position, on_particles), torque(at.topRows<2>(), f), 1e-14);
}

TEST(Lattice, ClampFixesTheLastColumnInsideAndEnoughOutside) {
  const Plate plate{.length = 0.4, .thickness = 0.02, .left = Support::clamped, .right = Support::free};
  const Lattice<2> inside = lattice_of(plate, 0.01), outside = lattice_of(plate, 0.01, ClampColumn::outside);
  EXPECT_EQ(inside.extent[0], 42);
  EXPECT_EQ(std::count(inside.inside.begin(), inside.inside.end(), 0), 4);
  EXPECT_NEAR(inside.position(0, inside.index({2, 0})), -0.195, 1e-15);  // centre half a spacing inside
  EXPECT_TRUE(inside.fixed[static_cast<std::size_t>(inside.index({2, 1}))]);
  EXPECT_FALSE(inside.fixed[static_cast<std::size_t>(inside.index({3, 1}))]);
  EXPECT_FALSE(outside.fixed[static_cast<std::size_t>(outside.index({2, 1}))]);
  EXPECT_TRUE(outside.fixed[static_cast<std::size_t>(outside.index({1, 1}))]);
  EXPECT_FALSE(inside.fixed.back());
}

TEST(TotalLagrangian, KeepsLinearAndAngularMomentumUnderAnyDeformation) {
  const Block block(ParticleModel::total_lagrangian);
  const Eigen::Matrix2Xd u = block.random(0.2 * Block::spacing), f = block.elastic->force(u);
  const double size = f.cwiseAbs().sum();
  EXPECT_LT(f.rowwise().sum().norm(), 1e-13 * size);
  EXPECT_LT(std::abs(torque(block.lattice.position + u, f)), 1e-13 * size * 0.06);  // arm: the block's length
}

TEST(PairModel, KeepsLinearMomentumUnderAnyDeformation) {
  const Block block(ParticleModel::pair);
  const Eigen::Matrix2Xd f = block.elastic->force(block.random(0.2 * Block::spacing));
  EXPECT_LT(f.rowwise().sum().norm(), 1e-13 * f.cwiseAbs().sum());
}

TEST(TotalLagrangian, ForceIsTheNegativeGradientOfItsEnergy) {
  for (const auto material : {MaterialModel::saint_venant_kirchhoff, MaterialModel::linear}) {
    const Block block(ParticleModel::total_lagrangian, material);
    const Eigen::Matrix2Xd u = block.random(0.1 * Block::spacing), f = block.elastic->force(u);
    const double step = 1e-5 * Block::spacing;  // central difference: truncation 1e-10, round-off 1e-11
    for (const Eigen::Index i : {0, 5, 23, 47}) {
      for (int axis = 0; axis < 2; ++axis) {
        Eigen::Matrix2Xd plus = u, minus = u;
        plus(axis, i) += step;
        minus(axis, i) -= step;
        const double gradient = (block.elastic->energy(plus) - block.elastic->energy(minus)) / (2 * step);
        EXPECT_NEAR(f(axis, i), -gradient, 1e-7 * f.cwiseAbs().maxCoeff());
      }
    }
  }
}

TEST(PairModel, ForceIsTheNegativeGradientOfItsEnergyForSmallStrains) {
  const Block block(ParticleModel::pair);
  const Eigen::Matrix2Xd u = block.random(1e-6 * Block::spacing), f = block.elastic->force(u);
  const double step = 1e-7 * Block::spacing;
  for (const Eigen::Index i : {0, 5, 23, 47}) {
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix2Xd plus = u, minus = u;
      plus(axis, i) += step;
      minus(axis, i) -= step;
      const double gradient = (block.elastic->energy(plus) - block.elastic->energy(minus)) / (2 * step);
      EXPECT_NEAR(f(axis, i), -gradient,
                  1e-4 * f.cwiseAbs().maxCoeff());  // the strains are 1e-6: second order
    }
  }
  EXPECT_LT(std::abs(torque(block.lattice.position, f)), 1e-5 * f.cwiseAbs().sum() * 0.06);
}

// A uniform strain must carry its exact uniform stress. There is no force inside, and the left half pulls at
// the right one with the resultant of the continuum, P·N times the area.
TEST(TotalLagrangian, PassesThePatchTest) {
  const double d = 0.005;
  constexpr int n = 16, reach = 4;  // two bonds: the faces have no effect deeper inside
  const Material material;
  const Lattice<2> lattice = lattice_of({.length = n * d, .thickness = n * d}, d);
  const Bonds<2> bonds = make_bonds<2>(lattice, 2.1);
  Eigen::Matrix2d F;
  F << 1.002, 0.001, -0.0005, 0.999;
  const Eigen::Matrix2Xd u = (F - Eigen::Matrix2d::Identity()) * lattice.position;
  const Eigen::Matrix2Xd f = TotalLagrangian<2>(lattice, bonds, 1.0).force(u);
  const Eigen::Matrix2d P = first_piola_kirchhoff<2>(material, F);
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int c = 0; c < n; ++c)
    for (int l = 0; l < n; ++l) {
      const auto force = f.col(lattice.index({c, l}));
      if (std::min({c, l, n - 1 - c, n - 1 - l}) >= reach) {
        EXPECT_LT(force.norm(), 1e-11 * P.norm() * d);
      }
      if (c >= n / 2) right += force;
    }
  EXPECT_LT((right + P.col(0) * n * d).norm(), 1e-11 * P.norm() * n * d);
}

TEST(PairModel, UniformStrainInsideTheLatticeIsInEquilibrium) {
  const double d = 0.005;
  Material material;
  const Lattice<2> lattice = lattice_of({.length = 16 * d, .thickness = 16 * d}, d);
  const Bonds<2> bonds = make_bonds<2>(lattice, 2.1);
  const PairModel model(lattice, bonds);
  Eigen::Matrix2d strain;
  strain << 1e-6, 4e-7, 4e-7, -5e-7;
  const Eigen::Matrix2Xd f = model.force(strain * lattice.position);
  const double scale = material.young * 1e-6 * d;
  for (int c = 6; c < 10; ++c)
    for (int l = 6; l < 10; ++l) EXPECT_LT(f.col(lattice.index({c, l})).norm(), 1e-6 * scale);
  EXPECT_GT(f.col(lattice.index({0, 8})).norm(), 0.1 * scale);  // the faces do have an effect there
}

TEST(BothModels, RigidMotionMakesNoStressAtAnyAngle) {
  for (const auto model : {ParticleModel::total_lagrangian, ParticleModel::pair}) {
    const Block block(model);
    const double scale = block.material.young * Block::spacing;
    for (const double angle : {0.1, 1.0, 2.5, -3.0}) {
      const Eigen::Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
      Eigen::Matrix2Xd u = block.uniform(R);
      u.colwise() += Eigen::Vector2d(0.3, -2.0);
      EXPECT_LT(block.elastic->force(u).cwiseAbs().maxCoeff(), 1e-11 * scale);
      EXPECT_LT(block.elastic->energy(u), 1e-20 * scale);
    }
  }
}

// R2: forces and torques are the gradient of its energy for small strains, at any turn of the whole.
TEST(PairModel, ForceAndTorqueOfTheDynamicRotationAreTheGradientOfItsEnergy) {
  const Block block(ParticleModel::pair);
  const PairModel model(block.lattice, block.bonds, Rotation::dynamic);
  const double size = 1e-6, angle = 0.7;
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Matrix2Xd u = block.uniform(R) + block.random(size * Block::spacing);
  const Eigen::VectorXd turn =
      Eigen::VectorXd::Constant(u.cols(), angle) + size * block.random(1).row(1).transpose();
  Eigen::VectorXd torque;
  const Eigen::Matrix2Xd f = model.force(u, turn, torque);
  for (const Eigen::Index i : {0, 5, 23, 47}) {
    const double step = 1e-7 * Block::spacing;
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix2Xd plus = u, minus = u;
      plus(axis, i) += step;
      minus(axis, i) -= step;
      const double gradient = (model.energy(plus, turn) - model.energy(minus, turn)) / (2 * step);
      EXPECT_NEAR(f(axis, i), -gradient, 1e-4 * f.cwiseAbs().maxCoeff());
    }
    Eigen::VectorXd plus = turn, minus = turn;
    plus[i] += 1e-7;
    minus[i] -= 1e-7;
    const double gradient = (model.energy(u, plus) - model.energy(u, minus)) / 2e-7;
    EXPECT_NEAR(torque[i], -gradient, 1e-4 * torque.cwiseAbs().maxCoeff());
  }
}

// Σ x_i × f_i + Σ M_i = 0 under any deformation: what R1 has for small strains only.
TEST(PairModel, DynamicRotationKeepsAngularMomentumUnderAnyDeformation) {
  const Block block(ParticleModel::pair);
  const PairModel model(block.lattice, block.bonds, Rotation::dynamic);
  const Eigen::Matrix2Xd u = block.random(0.2 * Block::spacing);
  const Eigen::VectorXd turn = 0.3 * block.random(1).row(0).transpose();
  Eigen::VectorXd torque_of;
  const Eigen::Matrix2Xd f = model.force(u, turn, torque_of);
  const double scale = f.cwiseAbs().sum() * 0.06;  // arm: the block's length
  const Eigen::Matrix2Xd x = block.lattice.position + u;
  EXPECT_LT(std::abs(torque(x, f) + torque_of.sum()), 1e-13 * scale);
  EXPECT_GT(std::abs(torque(x, block.elastic->force(u))), 1e-8 * scale);
}

TEST(BothModels, CheckerboardCostsEnergy) {
  for (const auto model : {ParticleModel::total_lagrangian, ParticleModel::pair}) {
    const Block block(model);
    Eigen::Matrix2Xd u(2, block.lattice.size());
    for (int c = 0; c < 12; ++c)
      for (int l = 0; l < 4; ++l) u.col(block.lattice.index({c, l})).setConstant((c + l) % 2 ? 1e-8 : -1e-8);
    // Energy of the size that a strain of u over a spacing has.
    EXPECT_GT(block.elastic->energy(u), 0.1 * block.material.young * 1e-16 * static_cast<double>(u.cols()));
  }
}

TEST(BothModels, ForceWithOneAndTwoThreadsIsBitEqual) {
  const double d = 0.001;
  const Material material;
  const Lattice<2> lattice = lattice_of({.length = 300 * d, .thickness = 16 * d}, d);
  ASSERT_GE(lattice.size(), parallel_from);
  const Bonds<2> bonds = make_bonds<2>(lattice, 2.1);
  const TotalLagrangian<2> lagrangian(lattice, bonds, 1.0);
  const PairModel pair(lattice, bonds);
  const Eigen::Matrix2Xd u = 1e-3 * lattice.position.array().sin().matrix();
  for (const ElasticModel<2>* model :
       {static_cast<const ElasticModel<2>*>(&lagrangian), static_cast<const ElasticModel<2>*>(&pair)}) {
    omp_set_num_threads(1);
    const Eigen::Matrix2Xd one = model->force(u);
    omp_set_num_threads(2);
    EXPECT_EQ(model->force(u), one);
  }
}

TEST(BothModels, ElasticLimitIsThatOfTheLargestEigenvalue) {
  const Plate plate{.length = 0.1, .thickness = 0.02, .left = Support::clamped, .right = Support::clamped};
  const Material material;
  const double d = 0.005, mass = material.density * d * d;
  const Lattice<2> lattice = lattice_of(plate, d);
  const Bonds<2> bonds = make_bonds<2>(lattice, 2.1);
  const TotalLagrangian<2> lagrangian(lattice, bonds, 1.0);
  const PairModel pair(lattice, bonds);
  for (const ElasticModel<2>* model :
       {static_cast<const ElasticModel<2>*>(&lagrangian), static_cast<const ElasticModel<2>*>(&pair)}) {
    const Eigen::MatrixXd K = stiffness<2>(*model, lattice, Eigen::Matrix2Xd::Zero(2, lattice.size()));
    EXPECT_LT((K - K.transpose()).norm(), 1e-9 * K.norm());
    const double omega2 = eigenvalues_of(K / mass).maxCoeff();
    // A power iteration approaches ω from below. The step may be up to 2 % too long, far inside the safety of
    // 0.8.
    EXPECT_NEAR(elastic_limit<2>(*model, lattice, Eigen::VectorXd::Constant(lattice.size(), mass)) /
                    (2 / std::sqrt(omega2)),
                1.01, 0.0101);
  }
}

// A block whose particles all turn against their neighbours' bonds has ω² = 24 μ/(ρ l0²) on a full lattice (I
// = m l0²/6, U = ½ n 4μV θ²): faster than any wave, so that this is what limits the step.
TEST(PairModel, SpinLimitsTheStepOfTheDynamicRotation) {
  const double d = 0.005;
  const Lattice<2> lattice = lattice_of({.length = 24 * d, .thickness = 24 * d}, d);
  const Bonds<2> bonds = make_bonds<2>(lattice, 2.1);
  const Material& steel = lattice.material(0);
  const Eigen::VectorXd mass = Eigen::VectorXd::Constant(lattice.size(), steel.density * d * d);
  const double kinematic = elastic_limit<2>(PairModel(lattice, bonds), lattice, mass);
  const double dynamic = elastic_limit<2>(PairModel(lattice, bonds, Rotation::dynamic), lattice, mass);
  const double spin = 2 / std::sqrt(24 * steel.lame_mu() / (steel.density * d * d));
  EXPECT_LT(dynamic, kinematic);
  EXPECT_LT(dynamic, 1.02 * spin);  // displacement joins in and stiffens the mode further
  EXPECT_GT(dynamic, 0.6 * spin);
}

}  // namespace particle_test
}  // namespace strake::structure
