#include "structure/fem/linear/linear_solver.hpp"

#include "proto/error.hpp"
#include "structure/fem/solver.hpp"
#include "tests/structure/body/boxes.hpp"
#include "tests/structure/fem/plate.hpp"

#include <gtest/gtest.h>

namespace strake::structure::fem {
namespace linear_solver_test {

/// A slab of three dimensions that is clamped at one end and pressed from above.
Parameters slab(LinearMethod method) {
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  SolidBox b = box("slab", {0, 0, 0}, {0.4, 0.05, 0.2});
  b.support[0] = Support::clamped;
  p.solid = solid_of_boxes(3, {b});
  p.load = {.kind = LoadKind::traction, .value = {0, -1e6, 0}, .face = "top", .at = {}, .ramp = 0};
  p.fem.refinement = 0;
  p.fem.linear_solver = method;
  p.surface_spacing = 0.1;
  return p;
}

TEST(LinearSolver, ConjugateGradientsFindWhatFactorsFindAndTheSameBitsEachTime) {
  FemSolver<3> model(slab(LinearMethod::direct));
  const Mesh<3>& mesh = model.mesh();
  const Matrix K = Assembly<3>(mesh, elastic_solid(slab(LinearMethod::direct)).parts)
                       .tangent(Eigen::VectorXd::Zero(mesh.n_unknowns()));
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(mesh.n_unknowns(), -1, 2);
  LinearSolver direct;
  ASSERT_TRUE(direct.factorise(K, mesh.fixed));
  const Eigen::VectorXd x = direct.solve(b);
  Eigen::VectorXd first;
  for (int i = 0; i < 2; ++i) {
    LinearSolver iterative(LinearMethod::cg_amg, {.per_node = 3, .rigid_motions = rigid_motions(mesh)});
    ASSERT_TRUE(iterative.factorise(K, mesh.fixed));
    const Eigen::VectorXd y = iterative.solve(b, 1e-12);
    EXPECT_GT(iterative.iterations(), 3);
    EXPECT_LT(iterative.iterations(), 60) << "multigrid, not conjugate gradients alone";
    EXPECT_LT((y - x).norm(), 1e-8 * x.norm());
    if (i == 0) first = y;
    EXPECT_EQ(y, first);
  }
  // The residual is what the tolerance says, in the norm it says.
  LinearSolver loose(LinearMethod::cg_amg, {.per_node = 3, .rigid_motions = rigid_motions(mesh)});
  ASSERT_TRUE(loose.factorise(K, mesh.fixed));
  Eigen::VectorXd free = b, r = b - K * loose.solve(b, 1e-4);
  for (const int i : mesh.fixed) free(i) = r(i) = 0;
  EXPECT_LE(r.norm(), 1e-4 * free.norm());
  EXPECT_GT(r.norm(), 1e-9 * free.norm()) << "and it stops there";
}

TEST(LinearSolver, AMatrixThatIsNotPositiveDefiniteIsAnErrorWithAFix) {
  FemSolver<3> model(slab(LinearMethod::direct));
  const Mesh<3>& mesh = model.mesh();
  const Assembly<3> assembly(mesh, elastic_solid(slab(LinearMethod::direct)).parts);
  Matrix K = assembly.tangent(Eigen::VectorXd::Zero(mesh.n_unknowns()));
  K.coeffs() -= 1e9 * assembly.mass().coeffs();  // between two modes
  LinearSolver iterative(LinearMethod::cg_amg, {.per_node = 3, .rigid_motions = rigid_motions(mesh)});
  iterative.factorise(K, mesh.fixed);
  try {
    iterative.solve(Eigen::VectorXd::LinSpaced(mesh.n_unknowns(), -1, 2));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::solver_fault);
    EXPECT_NE(error.fix().find("direct"), std::string::npos);
  }
}

/// Unknowns and stiffness of the slab.
struct Slab {
  FemSolver<3> model{slab(LinearMethod::direct)};
  const Mesh<3>& mesh = model.mesh();
  Assembly<3> assembly{mesh, elastic_solid(slab(LinearMethod::direct)).parts};
  Matrix K = assembly.tangent(Eigen::VectorXd::Zero(mesh.n_unknowns()));
  Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(mesh.n_unknowns(), -1, 2);
  NodalUnknowns unknowns{.per_node = 3, .rigid_motions = rigid_motions(mesh)};

  /// ‖b − A x‖ / ‖b‖ over the free unknowns.
  double residual(const Matrix& A, const Eigen::VectorXd& x) const {
    Eigen::VectorXd free = b, r = b - A * x;
    for (const int i : mesh.fixed) free(i) = r(i) = 0;
    return r.norm() / free.norm();
  }
};

TEST(LinearSolver, FactorsServeMatricesOfEveryKindAndGiveTheSameBitsEachTime) {
  const Slab s;
  Matrix indefinite = s.K, unsymmetric = s.K;
  indefinite.coeffs() -= 1e9 * s.assembly.mass().coeffs();
  for (int row = 0; row < unsymmetric.rows(); ++row)
    for (Matrix::InnerIterator entry(unsymmetric, row); entry; ++entry)
      if (entry.col() > row) entry.valueRef() *= 0.9;
  LinearSolver one(LinearMethod::direct, s.unknowns);  // one after the other: they have one pattern
  for (const Matrix& A : {s.K, indefinite, unsymmetric, s.K}) {
    ASSERT_TRUE(one.factorise(A, s.mesh.fixed));
    const Eigen::VectorXd x = one.solve(s.b);
    EXPECT_LT(s.residual(A, x), 1e-9);
    LinearSolver other(LinearMethod::direct, s.unknowns);
    ASSERT_TRUE(other.factorise(A, s.mesh.fixed));
    EXPECT_EQ(other.solve(s.b), x);
  }
}

TEST(LinearSolver, WhereNobodyAskedForConjugateGradientsFactorsTakeTheirPlace) {
  const Slab s;
  Matrix K = s.K;
  K.coeffs() -= 1e9 * s.assembly.mass().coeffs();  // between two modes: not positive definite
  const auto given_up = std::make_shared<GivenUp>();
  LinearSolver solver(LinearMethod::automatic, s.unknowns, given_up);
  ASSERT_TRUE(solver.factorise(s.K, s.mesh.fixed));
  solver.solve(s.b, 1e-6);
  EXPECT_GT(solver.iterations(), 3) << "it begins with the iteration";
  EXPECT_EQ(given_up->times, 0);

  ASSERT_TRUE(solver.factorise(K, s.mesh.fixed));
  const Eigen::VectorXd x = solver.solve(s.b);
  EXPECT_LT(s.residual(K, x), 1e-9);
  EXPECT_EQ(solver.iterations(), 0);
  EXPECT_EQ(given_up->times, 1);
  EXPECT_NE(given_up->why.find("positive definite"), std::string::npos) << given_up->why;
  EXPECT_EQ(solver.solve(s.b), x);
  EXPECT_EQ(given_up->times, 1) << "the factors serve on";
  solver.retry();
  EXPECT_EQ(solver.solve(s.b), x);
  EXPECT_EQ(given_up->times, 2) << "it has iterated again";
}

TEST(LinearSolver, BothGiveTheSameStaticsModesAndSteps) {
  std::vector<double> seen[2];
  for (const auto method : {LinearMethod::direct, LinearMethod::cg_amg}) {
    auto& values = seen[method == LinearMethod::cg_amg];
    FemSolver<3> solver(slab(method));
    for (const double f : solver.frequencies(2)) values.push_back(f);
    solver.solve_static();
    values.push_back(solver.displacement_at({0.4, 0.025, 0.1}).y());
    solver.set_unknowns(0 * solver.unknowns(), 0 * solver.unknowns());
    for (int i = 0; i < 5; ++i) solver.advance(1e-4 * i, 1e-4, Load());
    values.push_back(solver.displacement_at({0.4, 0.025, 0.1}).y());
  }
  ASSERT_EQ(seen[0].size(), seen[1].size());
  for (std::size_t i = 0; i < seen[0].size(); ++i) EXPECT_NEAR(seen[1][i] / seen[0][i], 1, 1e-6) << i;
}

TEST(LinearSolver, AutomaticDependsOnDimensionAndSizeAlone) {
  EXPECT_EQ(chosen(LinearMethod::automatic, 2, 1000000), LinearMethod::direct);
  EXPECT_EQ(chosen(LinearMethod::automatic, 3, 130000), LinearMethod::direct) << "factors take seconds";
  EXPECT_EQ(chosen(LinearMethod::automatic, 3, 1000000), LinearMethod::automatic) << "iterates first";
  EXPECT_EQ(chosen(LinearMethod::cg_amg, 2, 10), LinearMethod::cg_amg);
  EXPECT_EQ(chosen(LinearMethod::direct, 3, 1000000), LinearMethod::direct);
}

}  // namespace linear_solver_test
}  // namespace strake::structure::fem
