#include "proto/error.hpp"
#include "structure/body/mass.hpp"
#include "structure/fem/fem.hpp"
#include "structure/fem/mesh/refinement.hpp"
#include "structure/fem/solver.hpp"
#include "tests/structure/body/boxes.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure::fem {
namespace solid_test {

Parameters of(int dimension, const std::vector<SolidBox>& boxes, int refinement = 1) {
  return body_of_boxes(dimension, boxes, refinement, 0.05);
}

TEST(FemSolid, AMeshWhoseSupportsLeaveNothingFreeIsRefused) {
  Parameters p;
  p.plate = {.length = 0.1,
             .thickness = 0.3,
             .bottom = {0, 0, 0},
             .left = Support::clamped,
             .right = Support::clamped};
  p.fem.degree = 1;
  p.fem.refinement = 0;
  p.fem.cell_size = 1;
  try {
    const FemSolver<2> solver(p);
    ADD_FAILURE() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::case_file);
    EXPECT_NE(to_text(error).find("leave 0 free"), std::string::npos) << to_text(error);
  }
  p.fem.degree = 2;
  EXPECT_GT(FemSolver<2>(p).frequencies(1).front(), 0);
}

TEST(FemSolid, CellsOfAUnionConformAndKeepMassAndParts) {
  const std::vector<SolidBox> boxes = {soft_box("floor", {0, 0, 0}, {1, 0.1, 0}),
                                       soft_box("rib", {0.4, 0.1, 0}, {0.5, 0.4, 0})};
  const Solid solid = solid_of_boxes(2, boxes), fine = refined(solid, 2);
  EXPECT_NEAR(mass_of(fine).mass, mass_of(solid).mass, 1e-12 * mass_of(solid).mass);
  // Four cells through the floor and through the rib: each node of the junction belongs to both.
  int junction = 0;
  for (Eigen::Index i = 0; i < fine.node.cols(); ++i)
    junction += std::abs(fine.node(1, i) - 0.1) < 1e-12 && fine.node(0, i) > 0.4 - 1e-12 &&
                fine.node(0, i) < 0.5 + 1e-12;
  EXPECT_EQ(junction, 5);
}

// A body of boxes that is turned has the cells of the level one, and its frequencies; a turned end can be
// pinned, along the edge that it had.
TEST(FemSolid, ATurnedBodyHasTheCellsAndTheFrequenciesOfTheLevelOne) {
  for (const auto& [dimension, axis] : {std::pair<int, Eigen::Vector3d>(2, Eigen::Vector3d::UnitZ()),
                                        {3, Eigen::Vector3d::UnitZ()},
                                        {3, Eigen::Vector3d::UnitX()}})
    for (const Support support : {Support::clamped, Support::pinned}) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.5, axis).toRotationMatrix();
      SolidBox box = soft_box("strip", {0, 0, 0}, {1, 0.05, 0.2});
      box.support[0] = box.support[1] = support;
      const Parameters level = of(dimension, {box});
      Parameters turned = level;
      turned.solid.node = turn * level.solid.node;
      turned.solid.turn = turn;
      if (dimension == 2) turned.shape.corner = outer_polygons(turned.solid).front();
      EXPECT_EQ(refined_count(turned.solid, 1), refined_count(level.solid, 1));
      EXPECT_EQ(refined(turned.solid, 1).cell.cols(), refined(level.solid, 1).cell.cols());
      const auto expected = make_solver(level)->frequencies(3), found = make_solver(turned)->frequencies(3);
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(found[k] / expected[k], 1, 1e-6) << dimension << " " << axis.x() << " " << k;
    }
}

TEST(FemSolid, ItsCellsAreCountedBeforeTheyAreMade) {
  const std::vector<std::vector<SolidBox>> bodies = {
      {soft_box("floor", {0, 0, 0}, {1, 0.1, 1}), soft_box("rib", {0.4, 0.1, 0}, {0.5, 0.4, 1})},
      {soft_box("beam", {0, 0, 0}, {3, 0.02, 0.5})}};
  for (const auto& boxes : bodies)
    for (const int dimension : {2, 3})
      for (const int refinement : {0, 1, 3}) {
        if (dimension == 3 && refinement == 3) continue;
        Solid solid = solid_of_boxes(dimension, boxes);
        for (const Support support : {Support::free, Support::clamped}) {
          solid.supported = {{"left", support, facets_named(solid, "left")}};
          for (const double along : {0.0, 0.07})
            EXPECT_EQ(refined_count(solid, refinement, along), refined(solid, refinement, along).cell.cols());
        }
      }
}

// One cell through floor and rib; along them even ones of at most the size asked for.
TEST(FemSolid, CellsHaveTheSizeThatIsAskedFor) {
  const std::vector<SolidBox> boxes = {soft_box("floor", {0, 0, 0}, {1, 0.01, 0.6}),
                                       soft_box("rib", {0.495, 0.01, 0}, {0.505, 0.11, 0.6})};
  // Along x 10 + 1 + 10 cells of the floor, one of the rib; along y 1 and 2; along z 12.
  EXPECT_EQ(refined(solid_of_boxes(3, boxes), 0, 0.05).cell.cols(), (21 + 2) * 12);
  Parameters p = of(3, boxes, 0);
  EXPECT_EQ(size_along(p.fem, p.solid), 0) << "by the thickness";
  p.fem.strain = StrainField::solid_shell;
  EXPECT_EQ(size_along(p.fem, p.solid), 1.0 / 32) << "of the longest part";
  p.fem.cell_size = 0.05;
  EXPECT_EQ(size_along(p.fem, p.solid), 0.05);
}

TEST(FemSolid, ADenserPartWeighsMore) {
  std::vector<SolidBox> boxes = {soft_box("a", {0, 0, 0}, {1, 0.1, 0}),
                                 soft_box("b", {1, 0, 0}, {2, 0.1, 0})};
  boxes[1].material.density = 3000;
  const FemSolver<2> solver(of(2, boxes));
  const Assembly<2> assembly(solver.mesh(), solid_of_boxes(2, boxes).parts);
  EXPECT_NEAR(assembly.mass().sum() / 2, 100 + 300, 1e-9);
}

// Two bars in line, E and 2E, pulled: the second one stretches by half as much. ν = 0, so that plane strain
// is a bar.
TEST(FemSolid, EachPartHasItsOwnStiffness) {
  std::vector<SolidBox> boxes = {soft_box("a", {0, 0, 0}, {1, 0.1, 0}),
                                 soft_box("b", {1, 0, 0}, {2, 0.1, 0})};
  for (SolidBox& b : boxes) b.material.poisson = 0;
  boxes[1].material.young *= 2;
  boxes[0].support[0] = Support::clamped;
  Parameters p = of(2, boxes);
  p.load = {.kind = LoadKind::traction, .value = {1000, 0, 0}, .face = "b.right", .at = {}, .ramp = 0};
  FemSolver<2> solver(p);
  solver.solve_static();
  EXPECT_NEAR(solver.displacement_at({1, 0.05, 0}).x(), 1e-3, 1e-9);
  EXPECT_NEAR(solver.displacement_at({2, 0.05, 0}).x(), 1.5e-3, 1e-9);
}

TEST(FemSolid, AHeldPartMovesWithTheSupportsAlone) {
  std::vector<SolidBox> boxes = {soft_box("frame", {0, 0, 0}, {0.1, 0.1, 0}),
                                 soft_box("arm", {0.1, 0, 0}, {1, 0.1, 0})};
  boxes[0].constrained = true;
  Parameters p = of(2, boxes);
  p.load = {.kind = LoadKind::traction, .value = {0, -1, 0}, .face = "arm.top", .at = {}, .ramp = 0};
  FemSolver<2> solver(p);
  solver.solve_static();
  EXPECT_EQ(solver.displacement_at({0.05, 0.05, 0}).norm(), 0);
  EXPECT_LT(solver.displacement_at({1, 0.05, 0}).y(), 0);
}

// The left half with a face of symmetry bends as the whole does.
TEST(FemSolid, AFaceOfSymmetryStandsForTheOtherHalf) {
  const auto deflection = [](double right, Support at_right) {
    SolidBox b = soft_box("strip", {-0.5, 0, 0}, {right, 0.05, 0});
    b.support[0] = Support::clamped;
    b.support[1] = at_right;
    Parameters p = of(2, {b}, 2);
    p.load = {.kind = LoadKind::traction, .value = {0, -10, 0}, .face = "top", .at = {}, .ramp = 0};
    FemSolver<2> solver(p);
    solver.solve_static();
    return solver.displacement_at({0, 0.025, 0}).y();
  };
  EXPECT_NEAR(deflection(0, Support::symmetry) / deflection(0.5, Support::clamped), 1,
              1e-4);  // the grids differ
}

// Simply supported with one end that can draw in: no membrane force, the linear deflection of the beam. Both
// pinned ends of a linear strip give the same.
TEST(FemSolid, ARollerHoldsAcrossTheSpanOnly) {
  SolidBox b = soft_box("strip", {0, 0, 0}, {1, 0.05, 0});
  b.support[0] = Support::pinned;
  b.support[1] = Support::roller;
  Parameters p = of(2, {b}, 2);
  p.load = {.kind = LoadKind::traction, .value = {0, -10, 0}, .face = "top", .at = {}, .ramp = 0};
  FemSolver<2> solver(p);
  EXPECT_EQ(rigid_motions_left(solver.mesh()), 0);
  solver.solve_static();
  const double I = std::pow(0.05, 3) / 12, D = 1e6 * I / (1 - 0.09), G = 1e6 / 2.6;
  const double bending = 5 * 10 / (384 * D), shear = 10 / (8 * (5.0 / 6) * G * 0.05);
  EXPECT_NEAR(-solver.displacement_at({0.5, 0.025, 0}).y() / (bending + shear), 1, 2e-3);
  // drawn in or out: nothing in the linear theory; the end is free along x all the same
  EXPECT_EQ(solver.displacement_at({1, 0.025, 0}).y(), 0);
}

TEST(FemSolid, WithoutSupportsThereIsNoEquilibrium) {
  FemSolver<2> solver(of(2, {soft_box("free", {0, 0, 0}, {1, 0.1, 0})}));
  EXPECT_EQ(rigid_motions_left(solver.mesh()), 3);
  EXPECT_THROW(solver.solve_static(), Error);
}

TEST(FemSolid, ALinearFieldOfThreeDimensionsIsExact) {
  for (const int degree : {1, 2}) {
    const Solid solid = solid_of_boxes(
        3, {soft_box("slab", {0, 0, 0}, {1, 0.2, 0.7}), soft_box("rib", {0.4, 0.2, 0}, {0.6, 0.5, 0.7})});
    const Discretisation<3> d(solid, degree, 1);
    const Assembly<3> assembly(d.mesh(), solid.parts);
    Eigen::Matrix3d H;
    H << 1e-3, 2e-4, -3e-4, 5e-4, -2e-3, 1e-4, 2e-4, -1e-4, 3e-3;
    Eigen::VectorXd u(d.mesh().n_unknowns());
    for (int i = 0; i < d.mesh().n_nodes(); ++i) u.segment<3>(3 * i) = H * d.mesh().node.col(i);
    const Eigen::Matrix3d E = 0.5 * (H + H.transpose());
    const Material& m = solid.parts[0].material;
    const double density = 0.5 * m.lame_lambda() * E.trace() * E.trace() + m.lame_mu() * E.squaredNorm();
    const double volume = 0.2 * 0.7 + 0.2 * 0.3 * 0.7;
    EXPECT_NEAR(assembly.strain_energy(u), density * volume, 1e-10 * density * volume);
    // Inner nodes of a body under constant stress carry no force.
    const Eigen::VectorXd f = assembly.internal_force(u, u, 0);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < d.mesh().n_nodes(); ++i) sum += f.segment<3>(3 * i);
    EXPECT_NEAR(sum.norm(), 0, 1e-12 * f.norm());
    EXPECT_NEAR(d.face_sizes(facets_named(solid, "bottom")).sum(), 0.7, 1e-12);
    EXPECT_NEAR(d.face_sizes(facets_named(solid, "rib.top")).sum(), 0.2 * 0.7, 1e-12);
  }
}

// A strip of three dimensions with faces of symmetry in front and behind is in plane strain.
TEST(FemSolid, PlaneStrainIsASlabBetweenFacesOfSymmetry) {
  SolidBox flat = soft_box("strip", {0, 0, 0}, {1, 0.1, 0});
  flat.support[0] = Support::clamped;
  SolidBox slab = flat;
  slab.max.z() = 0.1;
  slab.support[4] = slab.support[5] = Support::symmetry;
  const auto tip = [](const Parameters& given) {
    Parameters p = given;
    p.load = {.kind = LoadKind::traction, .value = {0, -10, 0}, .face = "top", .at = {}, .ramp = 0};
    const std::unique_ptr<Solver> solver = make_solver(p);
    solver->solve_static();
    return solver->displacement_at({1, 0.05, 0.05}).y();
  };
  Parameters p2 = of(2, {flat}, 1), p3 = of(3, {slab}, 1);
  EXPECT_NEAR(tip(p3) / tip(p2), 1, 2e-3);  // the grids differ along x
}

TEST(FemSolid, AFrameOfThreeDimensionsHasHexahedraWithPositiveVolume) {
  SolidBox b = soft_box("slab", {0, 0, 0}, {1, 0.2, 0.6});
  b.support[0] = Support::clamped;
  const FemSolver<3> solver(of(3, {b}, 0));
  const Frame frame = solver.frame();
  ASSERT_EQ(frame.cells.rows(), 8);
  for (Eigen::Index c = 0; c < frame.cells.cols(); ++c) {
    const auto at = [&](int k) -> Eigen::Vector3d { return frame.position.col(frame.cells(k, c)); };
    EXPECT_GT((at(1) - at(0)).cross(at(3) - at(0)).dot(at(4) - at(0)), 0);
    EXPECT_NEAR((at(2) - at(1) - at(3) + at(0)).norm(), 0, 1e-12) << "a parallelogram, walked around";
  }
}

// A clamp holds all nodes of a warped end, and a traction acts on all of a warped side.
TEST(FemSolid, WarpedSidesAreHeldAndLoadedAsFlatOnesAre) {
  for (const int degree : {1, 2}) {
    const Discretisation<3> flat(warped_bar(0), degree, 0), warped(warped_bar(0.01), degree, 0);
    EXPECT_EQ(flat.mesh().fixed.size(), degree == 1 ? 27U : 75U);
    EXPECT_EQ(warped.mesh().fixed, flat.mesh().fixed);
    const CaseLoad load = {.kind = LoadKind::traction, .value = {0, -100, 0}, .face = "deck"};
    const auto sum = [&](const Discretisation<3>& d) {
      return d.case_force(load).reshaped(3, d.mesh().n_nodes()).row(1).sum();
    };
    EXPECT_NEAR(sum(flat), -20, 1e-12);
    EXPECT_NEAR(sum(warped) / -20, 1, 0.01) << "0.2 m² and what the twist adds";
  }
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  p.surface_spacing = 0.1;
  const auto first = [&](double warp) {
    p.solid = warped_bar(warp);
    return make_solver(p)->frequencies(1).front();
  };
  EXPECT_NEAR(first(1e-4) / first(0), 1, 1e-3);
}

}  // namespace solid_test
}  // namespace strake::structure::fem
