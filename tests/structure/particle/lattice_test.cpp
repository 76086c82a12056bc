#include "proto/error.hpp"
#include "structure/body/mass.hpp"
#include "structure/body/surface.hpp"
#include "structure/particle/linearised.hpp"
#include "structure/particle/pair_model.hpp"
#include "structure/particle/total_lagrangian.hpp"
#include "tests/structure/body/boxes.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace strake::structure {
namespace lattice_test {

using Eigen::Vector3d;

/// A hull of 0.3 × 0.08 m, open above, with walls of 10 mm and a rib at x = 0.
std::vector<SolidBox> hull() {
  return {box("bottom", {-0.15, 0, 0}, {0.15, 0.01, 0}), box("left", {-0.15, 0.01, 0}, {-0.14, 0.08, 0}),
          box("right", {0.14, 0.01, 0}, {0.15, 0.08, 0}), box("rib", {-0.005, 0.01, 0}, {0.005, 0.08, 0})};
}

/// Two walls of 10 mm on a floor with a slot of one spacing (5 mm) between them.
std::vector<SolidBox> slotted() {
  return {box("floor", {0, 0, 0}, {0.025, 0.01, 0}), box("left", {0, 0.01, 0}, {0.01, 0.05, 0}),
          box("right", {0.015, 0.01, 0}, {0.025, 0.05, 0})};
}

constexpr double d = 0.005, reach = 2.1;

Points outline_of(const Solid& solid, double spacing) {
  return outline(outer_polygons(solid).front(), spacing).position;
}

TEST(ParticleLattice, AHullHasTheMassCentreAndMomentOfItsParts) {
  std::vector<SolidBox> parts = hull();
  parts[3].material.density = 2000;
  const Solid solid = solid_of_boxes(2, parts);
  const MassProperties body = mass_of(solid);
  const auto lattice = make_lattice<2>(solid, d, reach);
  double mass = 0, inertia = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < lattice.size(); ++i) {
    const double m = lattice.material(i).density * lattice.volume(i);
    mass += m;
    moment += m * lattice.position.col(i);
    inertia += m * (lattice.position.col(i) - body.centre.head<2>()).squaredNorm();
  }
  EXPECT_NEAR(mass, body.mass, 1e-12 * body.mass);
  EXPECT_NEAR((moment / mass - body.centre.head<2>()).norm(), 0, 1e-15);
  EXPECT_NEAR(inertia, body.inertia(2, 2), 0.01 * body.inertia(2, 2));  // points for squares: m d²/6 each
}

TEST(ParticleLattice, BondsDoNotCrossASlot) {
  const auto lattice = make_lattice<2>(solid_of_boxes(2, slotted()), d, reach);
  const auto bonds = make_bonds<2>(lattice, reach);
  int over_floor = 0;
  for (Eigen::Index i = 0; i < lattice.size(); ++i)
    for (Eigen::Index b = bonds.first(i); b < bonds.end(i); ++b) {
      const auto a = lattice.position.col(i), c = lattice.position.col(bonds.to(b));
      if (a.x() > 0.01 || c.x() < 0.015) continue;  // from wall to wall
      EXPECT_LT(std::min(a.y(), c.y()), 0.01) << "from y = " << a.y() << " to " << c.y();
      ++over_floor;
    }
  EXPECT_GT(over_floor, 0);
}

TEST(ParticleLattice, TheWetSurfaceIsToldFromItsOwnWall) {
  const Solid solid = solid_of_boxes(2, slotted());
  const auto lattice = make_lattice<2>(solid, d, reach);
  const Points at = outline_of(solid, 0.0031);  // no multiple of the spacing
  const SparseRows N = interpolation<2>(lattice, at);
  EXPECT_LT((N * Eigen::VectorXd::Ones(lattice.size()) - Eigen::VectorXd::Ones(at.cols())).norm(), 1e-13);
  EXPECT_LT((N * lattice.position.transpose() - at.topRows<2>().transpose()).norm(), 1e-15);
  for (Eigen::Index p = 0; p < at.cols(); ++p)
    for (SparseRows::InnerIterator entry(N, p); entry; ++entry) {
      const Eigen::Vector2d X = lattice.position.col(entry.col());
      EXPECT_LT((X - at.col(p).head<2>()).norm(), 1.5 * std::sqrt(2) * d + 1e-12);
      if (at(1, p) < 0.01 + 1e-9 || X.y() < 0.01) continue;
      EXPECT_EQ(X.x() > 0.0125, at(0, p) > 0.0125);
    }
}

TEST(ParticleLattice, AnInnerCornerIsToldFromBothItsSidesAlike) {
  const Solid solid = solid_of_boxes(2, hull());
  const auto lattice = make_lattice<2>(solid, d, reach);
  const Points corners{{-0.14, 0.14, -0.005, 0.005}, {0.01, 0.01, 0.01, 0.01}, {0, 0, 0, 0}};
  const SparseRows N = interpolation<2>(lattice, corners);
  EXPECT_LT((N * lattice.position.transpose() - corners.topRows<2>().transpose()).norm(), 1e-15);
  for (const auto& [a, b] : {std::pair{0, 1}, {2, 3}}) {  // mirrored in x
    std::vector<std::array<double, 3>> left, right;
    for (SparseRows::InnerIterator e(N, a); e; ++e)
      left.push_back({lattice.position(1, e.col()), lattice.position(0, e.col()), e.value()});
    for (SparseRows::InnerIterator e(N, b); e; ++e)
      right.push_back({lattice.position(1, e.col()), -lattice.position(0, e.col()), e.value()});
    std::sort(left.begin(), left.end());
    std::sort(right.begin(), right.end());
    ASSERT_EQ(left.size(), right.size());
    ASSERT_EQ(left.size(), 7U) << "two cells that share a particle";
    for (std::size_t k = 0; k < left.size(); ++k)
      for (std::size_t q = 0; q < 3; ++q) EXPECT_NEAR(left[k][q], right[k][q], 1e-9);
  }
}

TEST(ParticleLattice, AClampHoldsItsOwnSideAndAHeldPartAllOfIt) {
  std::vector<SolidBox> parts = hull();
  parts[1].support[0] = Support::clamped;  // the left wall's outer side, not the bottom's
  parts[3].constrained = true;
  const auto lattice = make_lattice<2>(solid_of_boxes(2, parts), d, reach);
  for (Eigen::Index i = 0; i < lattice.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double x = lattice.position(0, i), y = lattice.position(1, i);
    const bool wall = y > 0.01;
    EXPECT_EQ(lattice.inside[k] != 0, x > -0.15);
    if (!lattice.inside[k]) {
      EXPECT_TRUE(wall && x > -0.16);
    }
    const bool held = wall && (x < -0.145 || std::abs(x) < 0.005);
    EXPECT_EQ(lattice.fixed[k] != 0, held) << x << " " << y;
  }
}

TEST(ParticleLattice, ASpacingThatDoesNotFitIsAnsweredByOneThatDoes) {
  std::vector<SolidBox> parts = hull();
  EXPECT_TRUE(lattice_fault(solid_of_boxes(2, parts), d).problem.empty());
  const SolidFault coarse = lattice_fault(solid_of_boxes(2, parts), 0.01);
  EXPECT_NE(coarse.problem.find("\"rib\""), std::string::npos) << coarse.problem;  // at half of 0.01
  EXPECT_NE(coarse.fix.find("spacing = 0.005"), std::string::npos) << coarse.fix;

  parts = slotted();
  const SolidFault thin = lattice_fault(solid_of_boxes(2, parts), 0.01);
  EXPECT_FALSE(thin.problem.empty());
  parts[2].min.x() = 0.0163;
  const SolidFault odd = lattice_fault(solid_of_boxes(2, parts), d);
  EXPECT_NE(odd.problem.find("\"right\" has a side at x = 0.0163"), std::string::npos) << odd.problem;
  EXPECT_NE(odd.fix.find("0.002"), std::string::npos) << odd.fix;  // a measure of 0.1 mm is of no use

  parts = {box("a", {0, 0, 0}, {0.03, 0.006, 0}), box("b", {0, 0.006, 0}, {0.03, 0.018, 0})};
  const SolidFault layers = lattice_fault(solid_of_boxes(2, parts), 0.006);
  EXPECT_NE(layers.problem.find("\"a\" is 0.006 m thin, 1 layers"), std::string::npos) << layers.problem;
  EXPECT_NE(layers.fix.find("spacing = 0.003"), std::string::npos) << layers.fix;
}

/// A bar of two materials in series, clamped at its left end and pulled at its right one, ν = 0:
///   Δ = σ (L_1/E_1 + L_2/E_2), to within two spacings of the softer one: the strain jumps between two
///   particles.
TEST(ParticleLattice, ABarOfTwoMaterialsStretchesAsSpringsInSeries) {
  std::vector<SolidBox> parts = {box("soft", {0, 0, 0}, {0.1, 0.02, 0}),
                                 box("stiff", {0.1, 0, 0}, {0.2, 0.02, 0})};
  for (SolidBox& part : parts) part.material.poisson = 0;
  parts[0].material.young = 1e9;
  parts[1].material.young = 4e9;
  parts[0].support[0] = Support::clamped;
  const Solid solid = solid_of_boxes(2, parts);
  const double stress = 1e4, expected = stress * (0.1 / 1e9 + 0.1 / 4e9);
  for (const auto model : {ParticleModel::total_lagrangian, ParticleModel::pair}) {
    const auto lattice = make_lattice<2>(solid, d, reach);
    const auto bonds = make_bonds<2>(lattice, reach);
    std::unique_ptr<ElasticModel<2>> elastic;
    if (model == ParticleModel::pair)
      elastic = std::make_unique<PairModel>(lattice, bonds);
    else
      elastic = std::make_unique<TotalLagrangian<2>>(lattice, bonds, 1.0);
    Vectors<2> force = Vectors<2>::Zero(2, lattice.size());
    for (Eigen::Index i = 0; i < lattice.size(); ++i)
      if (lattice.position(0, i) > 0.195) force(0, i) = stress * d;
    const Vectors<2> u = equilibrium<2>(*elastic, lattice, Constraints<2>(), force);
    const SparseRows N = interpolation<2>(lattice, Points{{0.2}, {0.01}, {0}});
    EXPECT_NEAR((N * u.row(0).transpose())(0), expected, 2 * stress * d / 1e9) << static_cast<int>(model);
  }
}

/// A body whose cells come from a mesh file, in the place of one of boxes.
Solid as_mesh(Solid solid) {
  solid.plane = {};
  return solid;
}

template <int dim>
void expect_same_lattice(const Solid& solid) {
  const auto boxes = make_lattice<dim>(solid, d, reach), mesh = make_lattice<dim>(as_mesh(solid), d, reach);
  ASSERT_EQ(mesh.size(), boxes.size());
  EXPECT_LT((mesh.position - boxes.position).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_EQ(mesh.fixed, boxes.fixed);
  EXPECT_EQ(mesh.inside, boxes.inside);
  EXPECT_EQ(mesh.part, boxes.part);
  EXPECT_LT((mesh.share.array() - 1).abs().maxCoeff(), 1e-12);
}

TEST(ParticleLattice, SamplesOfAMeshThatFillsTheLatticeAreTheBoxes) {
  std::vector<SolidBox> parts = hull();
  parts[1].support[3] = Support::clamped;
  parts[3].material.density = 2000;
  expect_same_lattice<2>(solid_of_boxes(2, parts));
  for (SolidBox& part : parts) {
    part.max.z() = 0.02;
    part.support[4] = Support::clamped;
  }
  expect_same_lattice<3>(solid_of_boxes(3, parts));
}

// A disc of 32 sectors, 10 and 20 particles across.
TEST(ParticleLattice, AnyShapeHasItsMassAndMomentWithinOnePercent) {
  constexpr double radius = 0.05;
  constexpr int sectors = 32;
  Solid disc;
  disc.node = Points::Zero(3, 1 + 2 * sectors);
  for (int k = 0; k < 2 * sectors; ++k) {
    const double turn = std::acos(-1.0) * k / sectors;
    disc.node.col(1 + k) << radius * std::cos(turn), radius * std::sin(turn), 0;
  }
  disc.cell.resize(4, sectors);
  for (int k = 0; k < sectors; ++k) {
    const int a = 1 + 2 * k, c = 1 + (2 * k + 2) % (2 * sectors);
    disc.cell.col(k) << 0, a, c, a + 1;
    disc.part_of.push_back(0);
  }
  disc.parts = {{"disc", {}, false}};
  find_facets(disc);
  const MassProperties body = mass_of(disc);
  for (const double spacing : {0.01, 0.005}) {
    EXPECT_EQ(lattice_fault(disc, spacing).problem, "") << spacing;
    const auto lattice = make_lattice<2>(disc, spacing, reach);
    const MassProperties particles = mass_of(lattice);
    EXPECT_NEAR(particles.mass / body.mass, 1, 0.01);
    EXPECT_NEAR(particles.inertia(2, 2) / body.inertia(2, 2), 1, 0.01);
    // The loaded surface is interpolated from the particles around it, exactly where motion is linear.
    const Points at = outline_of(disc, 0.004);
    const SparseRows N = interpolation<2>(lattice, at);
    EXPECT_LT((N * lattice.position.transpose() - at.topRows<2>().transpose()).norm(), 1e-14);
  }
  EXPECT_NE(lattice_fault(disc, 0.04).problem, "");
}

// A sheet one spacing thick across the lattice: some places at its surface have two particles beside them.
TEST(ParticleLattice, ASheetTooThinForItsParticlesIsAnsweredByASpacing) {
  constexpr int cells = 50;
  const double turn = std::acos(-1.0) / 12;
  Solid sheet;
  sheet.node = Points::Zero(3, 2 * (cells + 1));
  sheet.cell.resize(4, cells);
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j < 2; ++j)
      sheet.node.col(2 * k + j).head<2>() = Eigen::Rotation2Dd(turn) * Eigen::Vector2d(0.005 * k, 0.005 * j);
  for (int k = 0; k < cells; ++k) {
    sheet.cell.col(k) << 2 * k, 2 * k + 2, 2 * k + 1, 2 * k + 3;
    sheet.part_of.push_back(0);
  }
  sheet.parts = {{"sheet", {}, false}};
  find_facets(sheet);
  const Points at = outline_of(sheet, 0.004);
  try {
    interpolation<2>(make_lattice<2>(sheet, d, reach), at);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(to_text(error).find("fix: structure.particle.spacing = 0.0025"), std::string::npos)
        << to_text(error);
  }
  EXPECT_NO_THROW(interpolation<2>(make_lattice<2>(sheet, 0.25 * d, reach), at));
}

}  // namespace lattice_test
}  // namespace strake::structure
