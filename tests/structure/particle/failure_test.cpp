#include "structure/particle/failure.hpp"

#include "structure/particle/pair_model.hpp"
#include "tests/structure/pulled_bar.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure {
namespace failure_test {

// Two halves of a strip are drawn straight apart. Its ends are left out of the sum, so that it is periodic in
// effect. The pair model's energy loses G_c per area as its bonds break.
TEST(Failure, ABondStrainFromTheFractureEnergyTakesThatEnergyOfAStraightCrack) {
  for (const double radius : {2.1, 3.1})
    for (const double poisson : {0.0, 0.3}) {
      double taken[2];
      for (const int more : {0, 1}) {
        Parameters p;
        p.material.poisson = poisson;
        const double d = p.particle.spacing, height = (12 + 12 * more) * d;
        SolidBox box;
        box.name = "strip";
        box.max << 12 * d, height, 0;
        box.material = p.material;
        const auto lattice = make_lattice<2>(solid_of_boxes(2, {box}), d, radius);
        auto bonds = make_bonds<2>(lattice, radius);
        const PairModel model(lattice, bonds);
        FailureKeys keys;
        keys.criterion = FailureCriterion::bond_strain;
        keys.fracture_energy = 1e-6;  // strains of 1e-8: no rotation, no large strain
        Failure<2> failure(keys, 1, lattice, bonds);
        auto state = failure.intact();
        double released = 0;
        const double s = std::sqrt(keys.fracture_energy /
                                   (crack_constant(radius, p.material.lame_lambda() / p.material.lame_mu()) *
                                    p.material.lame_mu() * d));
        for (int k = 1; k <= 1200; ++k) {
          Vectors<2> u = Vectors<2>::Zero(2, lattice.size());
          for (Eigen::Index i = 0; i < u.cols(); ++i)
            if (lattice.position(0, i) > 6 * d)
              u(0, i) = 0.01 * k * s * d;  // the last breaks at |r⁰|²/Δx < 10
          if (!failure.look(u, 0.01 * k, state)) continue;
          const double before = model.energy(u);
          failure.apply(state);
          released += before - model.energy(u);
        }
        taken[more] = released / keys.fracture_energy / d;
      }
      // Each step finds bonds up to 1 % of s_c late, the first and most of them: 2 % of their energy.
      EXPECT_NEAR((taken[1] - taken[0]) / 12, 1, 0.02) << radius << " " << poisson;
    }
}

TEST(Failure, TheBandOfACrackIsALittleMoreThanTwoRows) {
  EXPECT_NEAR(crack_band(2, 2.1, 1).width, 2.48, 0.005);
  EXPECT_NEAR(crack_band(2, 1.5, 1).width, 2, 1e-12);  // bonds to the next layer only
  EXPECT_GT(crack_band(2, 3.1, 1).width, crack_band(2, 2.1, 1).width);
  EXPECT_GT(crack_band(3, 2.1, 1).width, 2);
}

TEST(Failure, WithoutDamageItChangesNothing) {
  Parameters p = pulled_bar(FailureCriterion::max_principal);
  p.failure.strength = 1e9;
  p.failure.fracture_energy = 1e9;
  Parameters intact = p;
  intact.failure = {};
  ParticleSolver<2> with(p), without(intact);
  pull_apart(with, 1);
  pull_apart(without, 1);
  with.advance(0, 2e-5, {});
  without.advance(0, 2e-5, {});
  EXPECT_EQ(with.displacement(), without.displacement());
  EXPECT_EQ(with.monitor().at("failure.bonds"), 0);
}

TEST(Failure, ABarPulledApartKeepsItsMomentumAndItsBooks) {
  for (const auto criterion :
       {FailureCriterion::bond_strain, FailureCriterion::max_principal, FailureCriterion::von_mises}) {
    ParticleSolver<2> solver(pulled_bar(criterion));
    pull_apart(solver, 0.5);
    const Energy start = solver.energy();
    for (int k = 0; k < 10; ++k) solver.advance(k * 6e-5, 6e-5, {});
    const Energy end = solver.energy();
    EXPECT_GE(solver.monitor().at("failure.bonds"), 18) << "4 + 6 + 8 bonds cross the notch";
    EXPECT_NEAR(end.released / (100 * ligament(8)), 1, 0.10) << static_cast<int>(criterion);
    // Leapfrog gives the energy of the short waves that a snapping bond leaves to a few per cent.
    EXPECT_NEAR(end.kinetic + end.strain + end.released, start.kinetic, 0.05 * end.released);
    EXPECT_LT(solver.momentum().norm(), 1e-10 * 40);  // [kg m/s] a block has 80 kg/m at 0.5 m/s
    // In two pieces that move steadily.
    const auto opening = [&] {
      return solver.displacement_at({0.04, 0.01, 0}).x() - solver.displacement_at({-0.02, 0.01, 0}).x();
    };
    const double before = opening();
    solver.advance(6e-4, 2e-4, {});
    EXPECT_NEAR(opening() - before, 2 * 0.5 * 2e-4, 0.1 * 2e-4) << static_cast<int>(criterion);
  }
}

TEST(Failure, ABarInSpaceTakesItsFractureEnergyAndKeepsItsBooks) {
  constexpr int layers = 6;
  ParticleSolver<3> solver(pulled_bar(FailureCriterion::max_principal, layers, 0.3, 3));
  pull_apart(solver, 0.5);
  const Energy start = solver.energy();
  for (int k = 0; k < 10; ++k) solver.advance(k * 6e-5, 6e-5, {});
  const Energy end = solver.energy();
  EXPECT_NEAR(end.released / (100 * ligament(layers) * 0.02), 1, 0.10);
  EXPECT_NEAR(end.kinetic + end.strain + end.released, start.kinetic, 0.05 * end.released);
  EXPECT_NEAR(solver.monitor().at("failure.parted.x"), 0.01, 0.02 / layers);
  EXPECT_LT(solver.momentum().norm(), 1e-10);  // [kg m/s] a block has 0.8 kg at 0.5 m/s
}

// The strip is drawn apart in two places at once.
template <int dim>
void parts_in_two_places(std::int64_t bonds) {
  constexpr double d = 1e-3;
  SolidBox box;
  box.name = "strip";
  box.max << 12 * d, 4 * d, (dim == 3 ? 4 * d : 0);
  const auto lattice = make_lattice<dim>(solid_of_boxes(dim, {box}), d, 2.1);
  auto own = make_bonds<dim>(lattice, 2.1);
  FailureKeys keys;
  keys.criterion = FailureCriterion::bond_strain;
  keys.critical_strain = 0.1;
  const Failure<dim> failure(keys, 1, lattice, own);
  auto state = failure.intact();
  Vectors<dim> u = Vectors<dim>::Zero(dim, lattice.size());
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    u(0, i) = d * ((lattice.position(0, i) > 8 * d) - (lattice.position(0, i) < 4 * d));
  ASSERT_TRUE(failure.look(u, 1, state));
  EXPECT_EQ(state.bonds, 2 * bonds);
  EXPECT_NEAR(state.record.parted.at.x(), 4 * d, 1e-12)
      << "the first of the two, not the middle of the strip";
  EXPECT_NEAR(state.record.parted.at.y(), 2 * d, 1e-12);
}

TEST(Failure, ABodyThatPartsInTwoPlacesAtOnceTellsOneOfThem) {
  parts_in_two_places<2>(4 + 6 + 8);
  parts_in_two_places<3>(16 + 48 + 36 + 32);
}

template <int dim>
void is_rewound_and_resumed(const Parameters& p) {
  ParticleSolver<dim> first(p), second(p);
  pull_apart(first, 1);
  for (int k = 0; k < 300 && first.energy().released == 0; ++k) first.advance(k * 1e-6, 1e-6, {});
  ASSERT_GT(first.energy().released, 0);
  first.save();
  Archive archive;
  first.write(archive);
  first.advance(3e-4, 4e-5, {});
  const Points once = first.displacement();
  const auto told = first.monitor();
  first.restore();
  EXPECT_LT(first.monitor().at("failure.energy"), told.at("failure.energy"));
  first.advance(3e-4, 4e-5, {});
  second.read(archive);
  second.advance(3e-4, 4e-5, {});
  EXPECT_EQ(first.displacement(), once);
  EXPECT_EQ(second.displacement(), once);
  EXPECT_EQ(first.monitor(), told);
  EXPECT_EQ(second.monitor(), told);
}

TEST(Failure, DamageIsRewoundAndResumedBitEqual) {
  for (const auto criterion : {FailureCriterion::bond_strain, FailureCriterion::von_mises})
    is_rewound_and_resumed<2>(pulled_bar(criterion, 8));
  is_rewound_and_resumed<3>(pulled_bar(FailureCriterion::max_principal, 6, 0.3, 3));
}

TEST(Failure, FramesShowTheDamageAndLinesWhatItCannotDo) {
  ParticleSolver<2> solver(pulled_bar(FailureCriterion::max_principal));
  pull_apart(solver, 0.25);
  for (int k = 0; k < 12; ++k) solver.advance(k * 1e-4, 1e-4, {});
  const Frame frame = solver.frame();
  EXPECT_EQ(frame.point_data.back().name, "damage");
  const Eigen::MatrixXd& damage = frame.point_data.back().value;
  EXPECT_EQ(damage.maxCoeff(), 1);
  for (Eigen::Index i = 0; i < damage.cols(); ++i)
    // F of the blocks' first layer depends on the bar too, which is a hundred times as soft.
    if (std::abs(solver.lattice().position(0, i) - 0.01) > 0.0125) {
      EXPECT_EQ(damage(0, i), 0) << "the blocks stay whole";
    }
  std::string all;
  for (const std::string& line : solver.lines()) all += line + "\n";
  EXPECT_NE(all.find("G_c = 100 J/m^2"), std::string::npos) << all;
  EXPECT_NE(all.find("not wetted"), std::string::npos) << all;
}

}  // namespace failure_test
}  // namespace strake::structure
