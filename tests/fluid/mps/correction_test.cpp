#include "fluid/mps/correction.hpp"

#include "fluid/boundary/collision.hpp"
#include "fluid/boundary/fill.hpp"
#include "tests/fluid/plate_case.hpp"

#include <gtest/gtest.h>

namespace strake::fluid {
namespace correction_test {

constexpr double l0 = 0.01, dt = 1e-4, mass = 1000 * l0 * l0;

struct Scene {
  Parameters p = tank_case(0.4, 0.2, l0, 0.2);
  State<2> state = fill<2>(p);
  Boundary<2> boundary;
  NeighbourSearch<2> search{2.1 * l0, 0};
  explicit Scene(const InterfaceMesh& body = {}) : boundary(p, body, {}, state) {
    p.scheme.collision_distance = 0.85;
  }
  const Neighbours& near() {
    const auto keep = [this](std::int32_t i, std::int32_t j) { return boundary.keep(state, i, j); };
    return search.update(state.position, boundary.tags(state), keep);
  }
  CollisionAccount<2> separate() {
    return separate_particles<2>(state, boundary, near(), p.scheme, dt, l0, mass);
  }
  Eigen::Vector2d momentum() const {
    return mass * state.velocity.leftCols(boundary.water()).rowwise().sum();
  }
  double energy() const { return 0.5 * mass * state.velocity.leftCols(boundary.water()).squaredNorm(); }
};

/// Disordered water, so that many pairs are too close and approach.
void disturb(Scene& scene) {
  std::srand(5);
  const auto n = scene.boundary.water();
  scene.state.position.leftCols(n) += 0.3 * l0 * Eigen::Matrix2Xd::Random(2, n);
  scene.state.velocity.leftCols(n) = 5 * Eigen::Matrix2Xd::Random(2, n);
}

// Two particles beside the seam, nearer than 0.7 l0 over it, that approach.
TEST(AntiPenetration, SeesPairsOverAPeriodicSeam) {
  Parameters p = tank_case(0.4, 0.2, l0, 0.2);
  p.periodic = {true, false, false};
  p.scheme.collision_distance = 0.85;
  State<2> state = fill<2>(p);
  const Boundary<2> boundary(p, {}, {}, state);
  std::int64_t left = -1, right = -1;
  for (std::int64_t i = 0; i < boundary.water(); ++i) {
    if (std::abs(state.position(1, i) + 0.5 * l0) > 1e-9) continue;
    if (state.position(0, i) < -0.2 + l0) left = i;
    if (state.position(0, i) > 0.2 - l0) right = i;
  }
  ASSERT_TRUE(left >= 0 && right >= 0);
  state.position(0, left) -= 0.4 * l0;
  state.velocity(0, left) = -1;
  NeighbourSearch<2> search(2.1 * l0, 0, boundary.tank().periodic());
  separate_particles<2>(state, boundary, search.update(state.position), p.scheme, dt, l0, mass);
  // Two equal bodies with the restitution b: −(1−b)/2 and −(1+b)/2 of the speed.
  EXPECT_NEAR(state.velocity(0, left), -0.5 * (1 - p.scheme.restitution), 1e-12);
  EXPECT_NEAR(state.velocity(0, right), -0.5 * (1 + p.scheme.restitution), 1e-12);
}

TEST(AntiPenetration, WaterBehindAWallGivesItsMomentumToTheTank) {
  Scene scene;
  scene.p.scheme.anti_penetration = AntiPenetration::none;
  scene.state.position.col(0) << 0.2 + 0.3 * l0, -0.1;
  scene.state.velocity.col(0) << 3, 1;
  const CollisionAccount<2> account = scene.separate();
  EXPECT_EQ(account.behind_walls, 1);
  EXPECT_LT((account.on_walls - mass * Eigen::Vector2d(3, 0)).norm(), 1e-12);
  EXPECT_LT((account.on_water + account.on_walls).norm(), 1e-12);
  EXPECT_EQ(scene.state.velocity.col(0), Eigen::Vector2d(0, 1));
  EXPECT_LE(scene.state.position(0, 0), 0.2);
}

class AntiPenetrationRule : public testing::TestWithParam<AntiPenetration> {};

TEST_P(AntiPenetrationRule, KeepsMomentumAndMakesNoEnergy) {
  Scene scene;
  scene.p.scheme.anti_penetration = GetParam();
  scene.p.scheme.gradient = Gradient::pairwise;
  disturb(scene);
  const Eigen::Vector2d before = scene.momentum();
  const double energy = scene.energy();
  const Vectors<2> velocity = scene.state.velocity;
  const CollisionAccount<2> account = scene.separate();
  ASSERT_GT(((scene.state.velocity - velocity).colwise().squaredNorm().array() > 0).count(), 100);
  EXPECT_LT((scene.momentum() - before - account.on_water).norm(), 1e-12 * mass * 5 * 800);
  EXPECT_LT((account.on_water + account.on_walls).norm(), 1e-12);
  EXPECT_LE(scene.energy(), energy);
}
INSTANTIATE_TEST_SUITE_P(Both, AntiPenetrationRule,
                         testing::Values(AntiPenetration::collision, AntiPenetration::average),
                         [](const auto& info) {
                           return std::string(info.param == AntiPenetration::collision ? "Collision"
                                                                                       : "Average");
                         });

TEST(AntiPenetration, TwoParticlesPartWithTheirCoefficientOfRestitution) {
  Scene scene;
  scene.p.scheme.gradient = Gradient::pairwise;
  scene.state.position.leftCols(scene.boundary.water()).row(0).array() += 10;  // all others far away
  scene.state.position.col(0) << 0, 0.1;
  scene.state.position.col(1) << 0.8 * l0, 0.1;
  scene.state.velocity.col(0) << 1, 0.5;
  scene.state.velocity.col(1) << -1, 0.5;
  scene.separate();
  EXPECT_NEAR(scene.state.velocity(0, 1) - scene.state.velocity(0, 0), 0.2 * 2, 1e-12);
  EXPECT_NEAR(scene.state.velocity(1, 0), 0.5, 1e-12);  // nothing along the contact
}

// A chain of three, and the same chain in the mirror with the numbers the other way round. While pairs met in
// the order of their numbers, a symmetric wedge got a side force from its two jets.
TEST(AntiPenetration, AChainPartsAlikeWhateverTheNumbersOfItsParticles) {
  for (const AntiPenetration rule : {AntiPenetration::collision, AntiPenetration::average}) {
    const Eigen::Array3d place(0, 0.45, 0.93), speed(2, 0.5, -1);
    const auto part = [&](bool mirrored) {
      Scene scene;
      scene.p.scheme.anti_penetration = rule;
      scene.state.position.leftCols(scene.boundary.water()).row(0).array() += 10;  // all others far away
      for (int k = 0; k < 3; ++k) {
        scene.state.position.col(k) << (mirrored ? -place[2 - k] : place[k]) * l0, 0.1;
        scene.state.velocity.col(k) << (mirrored ? -speed[2 - k] : speed[k]), 0;
      }
      scene.separate();
      return Eigen::Array3d(scene.state.velocity.row(0).head(3).transpose());
    };
    const Eigen::Array3d one = part(false), other = -part(true).reverse();
    EXPECT_LT((one - other).abs().maxCoeff(), 1e-12) << one.transpose() << " and " << other.transpose();
    EXPECT_GT((one - speed).abs().minCoeff(), 0.1);  // all have collided
  }
}

// The shear of any flow brings particles past one another at 0.8 l0.
TEST(AntiPenetration, WaterInsideCollidesOnlyWhenItIsNearerThanAnyShearBringsItWithTheLeastSquaresScheme) {
  for (const double apart : {0.8, 0.65}) {
    Scene scene;
    scene.state.position.leftCols(scene.boundary.water()).row(0).array() += 10;
    scene.state.position.col(0) << 0, 0.1;
    scene.state.position.col(1) << apart * l0, 0.1;
    scene.state.velocity.col(0) << 1, 0;
    scene.state.velocity.col(1) << -1, 0;
    scene.separate();
    EXPECT_NEAR(scene.state.velocity(0, 1) - scene.state.velocity(0, 0), apart > 0.7 ? -2 : 0.2 * 2, 1e-12);
  }
}

TEST(AntiPenetration, WaterBehindAWallIsPutBackOnItsFaceAndTheWallFeelsIt) {
  Scene scene;
  scene.p.scheme.anti_penetration = AntiPenetration::none;  // of pairs
  const auto corner = scene.boundary.water() - 1;           // of the tank at its right wall
  scene.state.position.col(corner) << 0.2 + 0.3 * l0, -0.2 - 0.2 * l0;
  scene.state.velocity.col(corner) << 3, -4;
  const CollisionAccount<2> account = scene.separate();
  EXPECT_EQ(scene.state.position(0, corner), 0.2);
  EXPECT_EQ(scene.state.position(1, corner), -0.2);
  EXPECT_EQ(scene.state.velocity(0, corner), 0);
  EXPECT_EQ(scene.state.velocity(1, corner), 0);
  EXPECT_LT((account.on_walls - mass * Vector<2>(3, -4)).norm(), 1e-12);
  EXPECT_LT((account.on_walls + account.on_water).norm(), 1e-12);
  // Over the rim there is no wall.
  scene.state.position.col(corner) << 0.2 + 0.3 * l0, 0.25;
  scene.separate();
  EXPECT_EQ(scene.state.position(0, corner), 0.2 + 0.3 * l0);
}

TEST(AntiPenetration, WaterInsideABodyIsPutBackOnItsFaceAndTheBodyFeelsIt) {
  Scene scene(rectangle(-0.1, 0.05, 0.2, 0.02, l0));
  scene.state.position.col(7) << 0.013, 0.052;  // 2 mm inside the lower face
  scene.state.velocity.col(7) << 0, 4;
  const CollisionAccount<2> account = scene.separate();
  EXPECT_EQ(account.inside, 1);
  EXPECT_LT(scene.state.position(1, 7), 0.05);
  EXPECT_NEAR(scene.state.position(0, 7), 0.013, 1e-9);
  EXPECT_NEAR(scene.state.velocity(1, 7), 0, 1e-12);
  EXPECT_NEAR(account.on_points.row(1).sum(), 4 * mass, 1e-12);
}

TEST(PressureGradient, SymmetricFormMovesNoCentreOfMass) {
  Scene scene;
  disturb(scene);
  scene.state.pressure = Eigen::VectorXd::Random(scene.state.pressure.size());
  std::vector<std::uint8_t> water(scene.state.kind.size(), 0);
  std::fill_n(water.begin(), scene.boundary.water(), std::uint8_t{1});
  const Vectors<2> gradient =
      pressure_gradient<2>(scene.state, scene.boundary, scene.near(), lattice_constants<2>(2.1, l0),
                           Gradient::pairwise, {water, water});
  EXPECT_LT(gradient.rowwise().sum().norm(), 1e-12 * gradient.colwise().norm().sum());
}

TEST(Shifting, EvensOutADisplacedParticleAndIsOffAtZeroStrength) {
  Scene scene;
  const std::int64_t middle = 10 * 40 + 20;
  std::fill(scene.state.surface.begin(), scene.state.surface.end(), std::uint8_t{0});
  const Eigen::Vector2d home = scene.state.position.col(middle);
  scene.state.position(0, middle) += 0.2 * l0;
  scene.state.velocity.setConstant(1);
  const LatticeConstants lattice = lattice_constants<2>(2.1, l0);
  shift_particles<2>(scene.state, scene.boundary, scene.near(), lattice, 0, 0.3, 1e-3, l0);
  EXPECT_NEAR((scene.state.position.col(middle) - home).norm(), 0.2 * l0, 1e-15);
  shift_particles<2>(scene.state, scene.boundary, scene.near(), lattice, 0.5, 0.3, 1e-3, l0);
  EXPECT_LT((scene.state.position.col(middle) - home).norm(), 0.2 * l0);
}

TEST(FaceLevel, UniformPressureMovesNoWaterAlongTheNormalOfAFaceAtAnyDistance) {
  for (const double gap : {-0.04, 0.0, 0.05}) {  // [l0] of the face from the water's surface
    Scene scene(rectangle(-0.1, gap * l0, 0.2, 0.02, l0));
    scene.state.pressure.setConstant(1e6);
    const Neighbours& near = scene.near();
    const LatticeConstants lattice = lattice_constants<2>(2.1, l0);
    const Eigen::VectorXd level = face_level<2>(scene.state, scene.boundary, near, lattice, l0);
    const auto gradient = [&](const Eigen::VectorXd& with) {
      return pressure_gradient<2>(scene.state, scene.boundary, near, lattice, Gradient::pairwise, {}, with);
    };
    const Vectors<2> levelled = gradient(level), plain = gradient({});
    int checked = 0;
    for (std::int64_t i = 0; i < scene.boundary.water(); ++i) {
      const Eigen::Vector2d x = scene.state.position.col(i);
      if (std::abs(x[0]) > 0.07 || x[1] < -l0) continue;  // the first layer, away from the plate's ends
      ++checked;
      EXPECT_LT(std::abs(levelled(1, i)), 1e-9 * 1e6 / l0);
      if (gap != 0) {
        EXPECT_GT(std::abs(plain(1, i)), 0.05 * 1e6 / l0);
      }
    }
    EXPECT_EQ(checked, 14);
  }
}

}  // namespace correction_test
}  // namespace strake::fluid
