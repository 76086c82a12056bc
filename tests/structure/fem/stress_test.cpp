#include "proto/error.hpp"
#include "structure/fem/mesh/recovery.hpp"
#include "structure/fem/solver.hpp"
#include "tests/structure/body/boxes.hpp"
#include "tests/structure/fem/plate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure::fem {
namespace stress_test {

template <int dim>
Eigen::MatrixXd recovered(const Mesh<dim>& mesh, const Assembly<dim>& assembly, const Recovery<dim>& recovery,
                          const Eigen::VectorXd& u) {
  Eigen::MatrixXd state(7, mesh.n_cells() * mesh.n_quadrature);
  for (int c = 0; c < mesh.n_cells(); ++c)
    state.middleCols(c * mesh.n_quadrature, mesh.n_quadrature) = assembly.cell_state(u, c);
  return recovery.on_nodes(state);
}

TEST(FemStress, VonMisesOfOneStrainIsItsClosedForm) {
  for (const int degree : {1, 2}) {
    Parameters p = plate(Support::free, Support::free, MaterialModel::linear);
    const Discretisation<2> d(elastic_solid(p), degree, 1);
    const Assembly<2> assembly(d.mesh(), elastic_solid(p).parts);
    const Recovery<2> recovery(d.mesh());
    ASSERT_EQ(recovery.size(), d.mesh().n_nodes()) << "one part: a point per node, in its order";
    Eigen::VectorXd u = Eigen::VectorXd::Zero(d.mesh().n_unknowns());
    for (int i = 0; i < d.mesh().n_nodes(); ++i) u(2 * i) = 1e-4 * d.mesh().node(0, i);
    // σ = λε 1 + 2με e⊗e, whose deviator has the von Mises stress 2με; ψ = (λ/2 + μ) ε².
    const Eigen::MatrixXd state = recovered(d.mesh(), assembly, recovery, u);
    const Eigen::MatrixXd mises = von_mises_of(state.topRows<6>());
    const Material& m = p.material;
    EXPECT_NEAR(mises.minCoeff() / (2e-4 * m.lame_mu()), 1, 1e-9);
    EXPECT_NEAR(mises.maxCoeff() / (2e-4 * m.lame_mu()), 1, 1e-9);
    EXPECT_NEAR(state.row(5).mean() / (1e-4 * m.lame_lambda()), 1, 1e-9) << "across the plane";
    EXPECT_NEAR(state.row(6).mean() / ((0.5 * m.lame_lambda() + m.lame_mu()) * 1e-8), 1, 1e-9);
  }
}

// u quadratic, hence stresses linear: quadratic cells have them exactly in every node, corners included.
TEST(FemStress, AStressThatIsLinearInSpaceIsRecoveredExactly) {
  const Solid solid = solid_of_boxes(3, {soft_box("slab", {0, 0, 0}, {1, 0.3, 0.4})});
  const Discretisation<3> d(solid, 2, 0);
  const Assembly<3> assembly(d.mesh(), solid.parts);
  const Recovery<3> recovery(d.mesh());
  const Material& m = solid.parts[0].material;
  Eigen::VectorXd u(d.mesh().n_unknowns());
  for (int i = 0; i < d.mesh().n_nodes(); ++i) {
    const Eigen::Vector3d X = d.mesh().node.col(i);
    u.segment<3>(3 * i) << 1e-3 * X.x() * X.y(), 2e-3 * X.y() * X.y(), 1e-3 * X.x() * X.z();
  }
  const Eigen::MatrixXd state = recovered(d.mesh(), assembly, recovery, u);
  const double size = 1e-3 * m.young;
  for (int i = 0; i < recovery.size(); ++i) {
    const Eigen::Vector3d X = d.mesh().node.col(i);
    const double xx = 1e-3 * X.y(), yy = 4e-3 * X.y(), zz = 1e-3 * X.x(), trace = xx + yy + zz;
    EXPECT_NEAR(state(0, i), m.lame_lambda() * trace + 2 * m.lame_mu() * xx, 1e-9 * size);
    EXPECT_NEAR(state(1, i), m.lame_mu() * 1e-3 * X.x(), 1e-9 * size);
    EXPECT_NEAR(state(2, i), m.lame_mu() * 1e-3 * X.z(), 1e-9 * size);
    EXPECT_NEAR(state(3, i), m.lame_lambda() * trace + 2 * m.lame_mu() * yy, 1e-9 * size);
    EXPECT_NEAR(state(5, i), m.lame_lambda() * trace + 2 * m.lame_mu() * zz, 1e-9 * size);
  }
}

// Extrapolated from points of quadrature, the energy of a cell that bends would be negative in places.
template <int dim>
void expect_energy_without_sign_or_loss(int degree) {
  const Solid solid = solid_of_boxes(dim, {soft_box("slab", {0, 0, 0}, {1, 0.3, dim == 3 ? 0.4 : 0})});
  const Discretisation<dim> d(solid, degree, 1);
  const Assembly<dim> assembly(d.mesh(), solid.parts);
  const Recovery<dim> recovery(d.mesh());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(d.mesh().n_unknowns());
  u.head<dim>().setConstant(1e-3);  // one node alone
  const int points = d.mesh().n_quadrature;
  Eigen::MatrixXd state(7, d.mesh().n_cells() * points);
  for (int c = 0; c < d.mesh().n_cells(); ++c)
    state.middleCols(c * points, points) = assembly.cell_state(u, c);
  const Eigen::RowVectorXd density = recovery.means_on_nodes(state.row(6));
  if (degree == 2) {
    EXPECT_LT(recovery.on_nodes(state.row(6)).minCoeff(), 0) << "the field is a hard one";
  }
  EXPECT_GE(density.minCoeff(), 0);
  EXPECT_NEAR(density * recovery.shares_of_volume(), state.row(6) * d.mesh().weight,
              1e-12 * state.row(6) * d.mesh().weight);
  // The corner of a box has an eighth of a piece in space, a quarter in the plane.
  const double piece = d.mesh().weight.head(points).sum() / std::pow(degree, dim);
  EXPECT_NEAR(recovery.shares_of_volume().minCoeff() / (piece / (1 << dim)), 1, 1e-9);
  // What is the same everywhere stays so.
  EXPECT_LT((recovery.means_on_nodes(Eigen::RowVectorXd::Ones(state.cols())).array() - 1).abs().maxCoeff(),
            1e-12);
}

TEST(FemStress, StrainEnergyInTheNodesIsNowhereNegativeAndSumsToThatOfTheCells) {
  for (const int degree : {1, 2}) {
    expect_energy_without_sign_or_loss<2>(degree);
    expect_energy_without_sign_or_loss<3>(degree);
  }
}

// A bar of two materials side by side, stretched alike: the stress jumps where they meet.
TEST(FemStress, BetweenTwoMaterialsTheJumpStays) {
  Material soft{.model = MaterialModel::linear, .density = 1000, .young = 1e6, .poisson = 0}, stiff = soft;
  stiff.young = 5e6;
  Parameters p;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(
      2, {box("soft", {0, 0, 0}, {1, 0.1, 0}, soft), box("stiff", {0, 0.1, 0}, {1, 0.2, 0}, stiff)});
  p.fem.refinement = 1;
  FemSolver<2> solver(p);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
  for (int i = 0; i < solver.mesh().n_nodes(); ++i) u(2 * i) = 1e-3 * solver.mesh().node(0, i);
  solver.set_unknowns(u, 0 * u);
  const Frame frame = solver.frame();
  EXPECT_GT(frame.position.cols(), solver.mesh().n_nodes()) << "two points in each node of the seam";
  ASSERT_EQ(frame.point_data[2].name, "stress");
  int low = 0, high = 0;
  for (Eigen::Index i = 0; i < frame.position.cols(); ++i) {
    const double xx = frame.point_data[2].value(0, i), y = frame.position(1, i);
    if (std::abs(y - 0.1) < 1e-9) {
      low += std::abs(xx - 1e3) < 1e-6;
      high += std::abs(xx - 5e3) < 1e-6;
      EXPECT_TRUE(std::abs(xx - 1e3) < 1e-6 || std::abs(xx - 5e3) < 1e-6) << xx;
    } else {
      EXPECT_NEAR(xx, y < 0.1 ? 1e3 : 5e3, 1e-6);
    }
  }
  EXPECT_EQ(low, high);
  EXPECT_GT(low, 2);
  EXPECT_NEAR(solver.stress_at({0.3, 0.04, 0})[0], 1e3, 1e-6);
  EXPECT_NEAR(solver.stress_at({0.3, 0.16, 0})[0], 5e3, 1e-6);
}

TEST(FemStress, AProbeInANodeShowsWhatTheFrameShows) {
  Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::saint_venant_kirchhoff);
  p.load = {.kind = LoadKind::traction, .value = {0, -1e6, 0}, .face = "top", .at = {}, .ramp = 0};
  for (const int degree : {1, 2}) {
    p.fem.degree = degree;
    FemSolver<2> solver(p);
    solver.solve_static();
    const Frame frame = solver.frame();
    const double scale = frame.point_data[3].value.maxCoeff();
    for (const int i : {0, 7, solver.mesh().n_nodes() - 1}) {
      const Eigen::Vector3d X(solver.mesh().node(0, i), solver.mesh().node(1, i), 0);
      const Stress stress = solver.stress_at(X);
      EXPECT_LT((stress - frame.point_data[2].value.col(i)).norm(), 1e-9 * scale);
      EXPECT_NEAR(von_mises(stress), frame.point_data[3].value(0, i), 1e-9 * scale);
    }
  }
}

// cases/VALIDATION.md, "Strips: deflection and frequencies": 10 MPa at mid-span, ±, by the beam; the plane
// adds σ_zz = ν σ_xx.
TEST(FemStress, TheClampedStripHasItsBendingStressAtMidSpan) {
  for (const int degree : {1, 2}) {
    Parameters p = plate(Support::clamped, Support::clamped, MaterialModel::linear);
    p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
    p.fem.refinement = 2;
    p.fem.degree = degree;
    FemSolver<2> solver(p);
    solver.solve_static();
    const Stress below = solver.stress_at({0, 0, 0}), above = solver.stress_at({0, 0.02, 0});
    // 1.5 %: a load on one side, which the beam theory neglects, is 1 % of the bending stress there.
    EXPECT_NEAR(below[0] / 10e6, 1, 0.015) << "Q" << degree;
    EXPECT_NEAR(above[0] / -10e6, 1, 0.015) << "Q" << degree;
    EXPECT_NEAR(below[5] / (0.3 * below[0]), 1, 0.02) << "Q" << degree;
  }
}

}  // namespace stress_test
}  // namespace strake::structure::fem
