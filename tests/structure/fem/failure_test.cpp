#include "proto/error.hpp"
#include "structure/fem/element/damage.hpp"
#include "structure/fem/solver.hpp"
#include "tests/structure/notched_cells.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strake::structure::fem {
namespace failure_test {

void pull_apart(FemSolver<2>& solver, double speed) {
  Eigen::VectorXd u = Eigen::VectorXd::Zero(solver.mesh().n_unknowns()), v = u;
  for (int i = 0; i < solver.mesh().n_nodes(); ++i) v(2 * i) = pulled(speed, solver.mesh().node(0, i));
  solver.set_unknowns(u, v);
}

Parameters bar(int layers, FailureCriterion criterion = FailureCriterion::max_principal, double lean = 0,
               bool in_line = false) {
  Parameters p = notched_cells(criterion, layers, lean, 0, in_line);
  p.fem.degree = 1;
  return p;
}

// The band is one column of cells: G_c on the ligament, and what the cells beside it lost.
TEST(FemFailure, ANotchedBarTakesItsFractureEnergyAndKeepsItsBooks) {
  for (const auto criterion : {FailureCriterion::max_principal, FailureCriterion::von_mises}) {
    FemSolver<2> solver(bar(8, criterion));
    pull_apart(solver, 0.5);
    const Energy start = solver.energy();
    for (int k = 0; k < 120; ++k) solver.advance(k * 5e-6, 5e-6, {});
    const Energy end = solver.energy();
    EXPECT_EQ(solver.monitor().at("failure.cells"), 4) << "the ligament's";
    EXPECT_NEAR(end.released / (100 * notched_ligament), 1, 0.10) << static_cast<int>(criterion);
    EXPECT_NEAR(end.kinetic + end.strain + end.released, start.kinetic, 1e-6 * start.kinetic);
    EXPECT_LT(end.strain, 0.05 * end.released);
    EXPECT_NEAR(solver.monitor().at("failure.parted.x"), 0.01, 0.0025);
    EXPECT_NEAR(solver.monitor().at("failure.parted.y"), 0.01, 1e-6);
    EXPECT_GE(solver.monitor().at("failure.parted.time"), solver.monitor().at("failure.start.time"));
  }
}

// A bar that stores more elastic energy at its strength than its crack dissipates cannot continue statically:
// it snaps back. Inertia takes the rest, and every step finds its equilibrium.
TEST(FemFailure, ABarThatSnapsBackGoesOnByItsInertia) {
  Parameters p = bar(8);
  p.failure.fracture_energy = 5;
  FemSolver<2> solver(p);
  pull_apart(solver, 0.2);
  const Energy start = solver.energy();
  double stored = 0;  // largest strain energy of the bar
  for (int k = 0; k < 60; ++k) {
    solver.advance(k * 1e-5, 1e-5, {});
    stored = std::max(stored, solver.energy().strain);
  }
  const Energy end = solver.energy();
  EXPECT_EQ(solver.monitor().at("failure.cells"), 4);
  EXPECT_GT(stored, 1.3 * end.released) << "else it would not snap back";
  EXPECT_GE(end.released, 5 * notched_ligament);
  EXPECT_LT(end.released, 1.3 * 5 * notched_ligament) << "the ligament, and what the cells beside it lost";
  EXPECT_NEAR(end.kinetic + end.strain + end.released, start.kinetic, 1e-6 * start.kinetic);
}

// Notches in one column of leaning cells: one crack, which follows them. Notches one above the other: each
// begins a crack of its own that follows its column past the other's, a bias of the mesh that no band mends.
TEST(FemFailure, ACrackAlongLeaningCellsTakesItsFractureEnergy) {
  constexpr double lean = 20 * std::numbers::pi / 180;
  for (const int degree : {1, 2})
    for (const bool in_line : {true, false}) {
      if (degree == 2 && !in_line) continue;
      Parameters p = bar(8, FailureCriterion::max_principal, lean, in_line);
      p.fem.degree = degree;
      FemSolver<2> solver(p);
      pull_apart(solver, 0.5);
      for (int k = 0; k < 80; ++k) solver.advance(k * 5e-6, 5e-6, {});
      const int cracks = in_line ? 1 : 2;
      EXPECT_EQ(solver.monitor().at("failure.cells"), 4 * cracks);
      EXPECT_NEAR(solver.energy().released / (100 * notched_ligament) / cracks, 1, 0.10)
          << "degree " << degree << (in_line ? ", in line" : ", above one another");
    }
}

// A column of cells in either block is drawn open.
TEST(FemFailure, ABodyThatPartsInTwoPlacesAtOnceTellsOneOfThem) {
  const Parameters p = bar(8);
  const FemSolver<2> solver(p);
  const Mesh<2>& mesh = solver.mesh();
  const Assembly<2> assembly(mesh, p.solid.parts);
  const Damage<2> damage(p.failure, mesh, assembly);
  auto state = damage.intact();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh.n_unknowns());
  for (int i = 0; i < mesh.n_nodes(); ++i)
    u(2 * i) = 2.5e-3 * ((mesh.node(0, i) > 0.029) - (mesh.node(0, i) < -0.009));
  ASSERT_TRUE(damage.look(u, 1, state));
  EXPECT_EQ(state.eroded, 16);
  EXPECT_NEAR(state.record.parted.at.x(), -0.00875, 1e-12)
      << "the first of the two, not the middle of the bar";
  EXPECT_NEAR(state.record.parted.at.y(), 0.01, 1e-12);
}

TEST(FemFailure, DamageIsRewoundAndResumedBitEqual) {
  const Parameters p = bar(4);
  FemSolver<2> first(p), second(p);
  pull_apart(first, 1);
  int k = 0;
  for (; first.energy().released == 0; ++k) {
    ASSERT_LT(k, 100);
    first.advance(k * 4e-6, 4e-6, {});
  }
  first.save();
  Archive archive;
  first.write(archive);
  const auto go_on = [&](FemSolver<2>& solver) {
    for (int n = k; n < k + 10; ++n) solver.advance(n * 4e-6, 4e-6, {});
  };
  go_on(first);
  const Eigen::VectorXd once = first.unknowns();
  const auto told = first.monitor();
  EXPECT_GT(told.at("failure.energy"), 0);
  first.restore();
  EXPECT_LT(first.monitor().at("failure.energy"), told.at("failure.energy"));
  go_on(first);
  second.read(archive);
  go_on(second);
  EXPECT_EQ(first.unknowns(), once);
  EXPECT_EQ(second.unknowns(), once);
  EXPECT_EQ(first.monitor(), told);
  EXPECT_EQ(second.monitor(), told);
}

TEST(FemFailure, FramesShowTheDamageAndLinesWhatItCannotDo) {
  FemSolver<2> solver(bar(4));
  pull_apart(solver, 0.5);
  for (int k = 0; k < 40; ++k) solver.advance(k * 2e-5, 2e-5, {});
  const Frame frame = solver.frame();
  EXPECT_EQ(frame.point_data.back().name, "damage");
  EXPECT_EQ(frame.point_data.back().value.maxCoeff(), 1);
  std::string all;
  for (const std::string& line : solver.lines()) all += line + "\n";
  for (const char* words : {"G_c = 100 J/m^2", "no plastic flow", "not wetted", "mass stay"})
    EXPECT_NE(all.find(words), std::string::npos) << all;
}

TEST(FemFailure, CellsTooWideForTheSofteningAreRefused) {
  Parameters p = bar(4);
  p.failure.fracture_energy = 5;
  try {
    FemSolver<2> solver(p);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("refinement"), std::string::npos) << error.what();
  }
}

}  // namespace failure_test
}  // namespace strake::structure::fem
