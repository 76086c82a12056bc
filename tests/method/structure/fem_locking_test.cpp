#include "tests/method/structure/locking_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace strake::structure::fem {
namespace fem_locking_test {

constexpr Material cook_plane_stress{
    .model = MaterialModel::linear, .density = 1, .young = 1, .poisson = 1 / 3.0, .plane_stress = true};

Material almost_incompressible(double poisson, MaterialModel model = MaterialModel::linear) {
  return {.model = model, .density = 1, .young = 1, .poisson = poisson};
}

// Gates are what fem_locking_benchmark measures, rounded up, so that they stand for these meshes alone.

// 23.883 of 16 × 16 enhanced cells, 23.016 of 4 × 4, without 18.299. The reference 23.96 is that of refined
// meshes throughout the literature since Simo & Rifai 1990.
TEST(Locking, CooksPanelRisesAsItsReferenceWithSixteenEnhancedCells) {
  EXPECT_NEAR(cooks_rise(16, cook_plane_stress, q1_cured) / 23.96, 1, 0.005);
  EXPECT_LT(cooks_rise(4, cook_plane_stress, q1_plain) / cooks_rise(4, cook_plane_stress, q1_cured), 0.9)
      << "what the cure does on a coarse mesh";
}

// Deflection over that of the finest mesh, 18.526 and 18.505. 16 × 16 enhanced Q1 has 0.987, 4 × 4 enhanced
// Q2 0.999, Q1 without enhancement 0.48 and 0.31.
TEST(Locking, CooksPanelOfConstantVolumeDoesNotLock) {
  for (const double poisson : {0.499, 0.4999}) {
    const Material m = almost_incompressible(poisson);
    const double fine = cooks_rise(32, m, q2_cured), cured = cooks_rise(16, m, q1_cured);
    RecordProperty("enhanced_over_fine", std::to_string(cured / fine));
    EXPECT_NEAR(cured / fine, 1, 0.02) << poisson;
    EXPECT_LT(cooks_rise(16, m, q1_plain) / fine, 0.6) << poisson << ": it locks without";
    EXPECT_NEAR(cooks_rise(4, m, q2_cured) / fine, 1, 0.005) << poisson;
  }
}

// cases/VALIDATION.md, "Strips: deflection and frequencies".
TEST(Locking, AStripOfFourEnhancedCellsThroughItBendsAsTheReference) {
  EXPECT_NEAR(strip_deflection(q1_cured, 2, false) / 4.462e-5, 1, 0.01);
  EXPECT_NEAR(strip_deflection(q1_cured, 2, true) / 2.0822e-3, 1, 0.01);
  EXPECT_LT(strip_deflection(q1_plain, 2, true) / 2.0822e-3, 0.98) << "it locks without";
}

// Two cells through it have 0.980 of Q2's deflection at 0.3 and 0.938 at 0.499, four 0.992 and 0.974. At the
// edges of the clamped face, which constrains the volume too, stresses have no bound. Without enhanced
// strains 0.86 and 0.28.
TEST(Locking, ABarOfThreeDimensionsNeitherLocksInBendingNorAtConstantVolume) {
  for (const auto& [poisson, gate, locked] : {std::array{0.3, 0.03, 0.9}, {0.499, 0.07, 0.4}}) {
    const Material m = almost_incompressible(poisson);
    const double reference = bar_over_beam(4, 2, m, q2_cured);
    EXPECT_NEAR(bar_over_beam(4, 2, m, q1_cured) / reference, 1, gate) << poisson;
    EXPECT_LT(bar_over_beam(4, 2, m, q1_plain) / reference, locked) << poisson << ": it locks without";
  }
}

// Large deformation: the end sinks by a fifth of the length, and the enhanced strains are found with it. Of
// 4.4 % and 4.6 % that it is stiffer than one Q2 cell through it, 1.9 % are gone with two; without 24 %.
TEST(Locking, LargeBendingOfEnhancedCellsIsThatOfQuadraticOnes) {
  for (const auto model : {MaterialModel::saint_venant_kirchhoff, MaterialModel::neo_hookean}) {
    const Material m = almost_incompressible(0.45, model);
    const double linear = bar_over_beam(6, 1, almost_incompressible(0.45), q2_cured, 0, 0.3),
                 quadratic = bar_over_beam(6, 1, m, q2_cured, 0, 0.3),
                 enhanced = bar_over_beam(6, 2, m, q1_cured, 0, 0.3);
    EXPECT_GT(std::abs(quadratic / linear - 1), 0.02) << "the deformation must be large";
    EXPECT_NEAR(enhanced / quadratic, 1, 0.05);
    EXPECT_LT(bar_over_beam(6, 2, m, q1_plain, 0, 0.3) / quadratic, 0.8) << "it locks without";
  }
}

// A turned body stores nothing, whatever strains its cells add.
TEST(Locking, EnhancedStrainsStoreNothingInARotation) {
  for (const auto model : {MaterialModel::saint_venant_kirchhoff, MaterialModel::neo_hookean}) {
    const FemSolver<2> solver(cooks_panel(4, almost_incompressible(0.49, model), q1_cured));
    const Assembly<2> assembly(solver.mesh(), {{"panel", almost_incompressible(0.49, model), false}},
                               StrainField::enhanced);
    Eigen::Matrix2d turn;
    turn << std::cos(2.0) - 1, -std::sin(2.0), std::sin(2.0), std::cos(2.0) - 1;
    Eigen::VectorXd u(solver.mesh().n_unknowns());
    for (int i = 0; i < solver.mesh().n_nodes(); ++i) u.segment<2>(2 * i) = turn * solver.mesh().node.col(i);
    // 1440 of area, strains of round-off.
    EXPECT_LT(assembly.strain_energy(u), 1e-24 * 1440 * 20);
    EXPECT_LT(assembly.internal_force(u, u, 0).norm(), 1e-10);
  }
}

// Uniform strain on cells of any shape: no forces inside, whatever the enhanced strains (the patch test).
TEST(Locking, DistortedEnhancedCellsPassThePatchTest) {
  Parameters p = cooks_panel(4, almost_incompressible(0.3), q1_cured);
  for (const Kind kind : {q1_cured, q2_cured}) {
    const Discretisation<2> d(p.solid, kind.degree, 0);
    const Assembly<2> assembly(d.mesh(), p.solid.parts, StrainField::enhanced);
    Eigen::Matrix2d H;
    H << 1e-3, 3e-3, -2e-3, 4e-3;
    Eigen::VectorXd u(d.mesh().n_unknowns());
    for (int i = 0; i < d.mesh().n_nodes(); ++i) u.segment<2>(2 * i) = H * d.mesh().node.col(i);
    const Eigen::VectorXd f = assembly.internal_force(u, u, 0);
    double inside = 0;
    int count = 0;
    for (int i = 0; i < d.mesh().n_nodes(); ++i) {
      const double s = d.mesh().node(0, i) / 48, t = (d.mesh().node(1, i) - 44 * s) / (44 - 28 * s);
      if (std::min({s, 1 - s, t, 1 - t}) < 1e-6) continue;
      inside = std::max(inside, f.segment<2>(2 * i).norm());
      ++count;
    }
    EXPECT_GT(count, 8);
    EXPECT_LT(inside, 1e-12 * f.norm());
  }
}

}  // namespace fem_locking_test
}  // namespace strake::structure::fem
