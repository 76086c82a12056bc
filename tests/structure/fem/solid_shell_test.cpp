#include "structure/fem/element/solid_shell.hpp"

#include "proto/error.hpp"
#include "structure/fem/linear/linear_solver.hpp"
#include "structure/fem/mesh/recovery.hpp"
#include "structure/fem/mesh/refinement.hpp"
#include "structure/fem/solver.hpp"
#include "structure/material/symmetric.hpp"
#include "tests/structure/body/boxes.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace strake::structure::fem {
namespace solid_shell_test {

using Eigen::Vector3d;
using Map = std::function<Vector3d(double, double, double)>;  // of (0, 1)² × (−½, ½)
constexpr double pi = std::numbers::pi;

Material elastic(double young, double poisson, MaterialModel model = MaterialModel::linear) {
  return {.model = model, .density = 1000, .young = young, .poisson = poisson};
}

/// A shell of nx × ny cells, one through the thickness.
Solid shell(int nx, int ny, const Material& material, const Map& map) {
  Solid solid;
  for (int i = 0; i <= nx; ++i) solid.plane[0].push_back(i);
  for (int i = 0; i <= ny; ++i) solid.plane[1].push_back(i);
  solid.plane[2] = {-0.5, 0.5};
  solid.parts = {{"shell", material}};
  solid.dimension = 3;
  fill_grid(solid, [](const auto&) { return 0; });
  solid.plane = {};
  for (Eigen::Index i = 0; i < solid.node.cols(); ++i) {
    const Vector3d xi = solid.node.col(i);
    solid.node.col(i) = map(xi.x() / nx, xi.y() / ny, xi.z());
  }
  find_facets(solid);
  return solid;
}

/// A plate 1 × 0.8 m in the plane whose inner nodes are moved, both layers alike.
Map distorted(double thickness) {
  return [=](double s, double t, double z) {
    const double away = 16 * s * (1 - s) * t * (1 - t);
    return Vector3d(s + 0.12 * away * std::sin(5 * t + 9 * s), 0.8 * t + 0.1 * away * std::cos(7 * s - 4 * t),
                    thickness * z);
  };
}

/// A piece of a warped shell whose thickness varies.
Map warped(double thickness) {
  return [=](double s, double t, double z) {
    return Vector3d(s + 0.1 * t * t, t + 0.15 * s * t,
                    0.2 * std::sin(2 * s) * (1 + t) + thickness * z * (1 + 0.3 * s));
  };
}

struct Body {
  Body(Solid made, StrainField strain = StrainField::solid_shell)
      : solid(std::move(made)), d(solid, 1, 0), assembly(d.mesh(), solid.parts, strain) {}
  const Mesh<3>& mesh() const { return d.mesh(); }
  Solid solid;
  Discretisation<3> d;
  Assembly<3> assembly;
};

template <class Function>
Eigen::VectorXd on_nodes(const Mesh<3>& mesh, const Function& field) {
  Eigen::VectorXd u(mesh.n_unknowns());
  for (int i = 0; i < mesh.n_nodes(); ++i) u.segment<3>(3 * i) = field(Vector3d(mesh.node.col(i)));
  return u;
}

/// A measured figure, for --gtest_output=xml.
void note(const std::string& what, double value) {
  testing::Test::RecordProperty(what, std::to_string(value));
}

/// Unknowns of the nodes where `held` says so of a component.
std::vector<int> fixed_where(const Mesh<3>& mesh, const std::function<bool(const Vector3d&, int)>& held) {
  std::vector<int> fixed;
  for (int i = 0; i < mesh.n_nodes(); ++i)
    for (int k = 0; k < 3; ++k)
      if (held(mesh.node.col(i), k)) fixed.push_back(3 * i + k);
  return fixed;
}

Eigen::VectorXd solve(const Matrix& K, const std::vector<int>& fixed, Eigen::VectorXd r) {
  LinearSolver factors(LinearMethod::direct, {.per_node = 3, .rigid_motions = {}},
                       std::make_shared<GivenUp>());
  EXPECT_TRUE(factors.factorise(K, fixed));
  for (const int i : fixed) r(i) = 0;
  return factors.solve(r, 1e-12);
}

// Given the exact displacement on the outer nodes, the inner nodes find theirs: on distorted cells, for
// constant membrane strain, bending and twist, thick and thin.
TEST(SolidShell, PassesThePatchTestsOfMembraneAndBending) {
  for (const double t : {0.1, 0.001})
    for (const bool bends : {false, true}) {
      const Body body(shell(4, 4, elastic(1e6, 0.3), distorted(t)));
      const double across = -0.3 / 0.7;  // of the strains in the plane, without a stress across it
      const Eigen::VectorXd exact = on_nodes(body.mesh(), [&](const Vector3d& X) -> Vector3d {
        if (!bends) return {1e-3 * X.x() + 2e-4 * X.y(), 3e-4 * X.x() - 5e-4 * X.y(), across * 5e-4 * X.z()};
        const double k1 = 0.02, k2 = -0.01, k12 = 0.015;
        return {-X.z() * (k1 * X.x() + k12 * X.y()), -X.z() * (k2 * X.y() + k12 * X.x()),
                0.5 * k1 * X.x() * X.x() + 0.5 * k2 * X.y() * X.y() + k12 * X.x() * X.y()};
      });
      const auto fixed = fixed_where(body.mesh(), [](const Vector3d& X, int) {
        return std::min({X.x(), 1 - X.x(), X.y(), 0.8 - X.y()}) < 1e-9;
      });
      Eigen::VectorXd outer = Eigen::VectorXd::Zero(exact.size());
      for (const int i : fixed) outer(i) = exact(i);
      const Matrix K = body.assembly.tangent(outer);
      const Eigen::VectorXd u = outer + solve(K, fixed, -K * outer);
      EXPECT_LT((u - exact).norm(), 1e-12 / (t * t) * exact.norm()) << t << " " << bends;
      const double E = 1e6, D = E * t * t * t / 12 / 0.91;
      const double bending =
          0.5 * D * (0.02 * 0.02 + 0.01 * 0.01 - 2 * 0.3 * 0.02 * 0.01 + 2 * 0.7 * 0.015 * 0.015);
      if (!bends) continue;
      EXPECT_NEAR(body.assembly.strain_energy(u) / (0.8 * bending), 1, 1e-7) << t;
    }
}

// On warped cells whose thickness varies a uniform strain is met to second order in their size.
TEST(SolidShell, AUniformStrainOfAWarpedShellConvergesWithTheSizeOfItsCells) {
  Eigen::Matrix3d H;
  H << 1e-3, 2e-4, -3e-4, 5e-4, -2e-3, 1e-4, 2e-4, -1e-4, 3e-3;
  const Material m = elastic(1e6, 0.3);
  const Eigen::Matrix3d E = 0.5 * (H + H.transpose());
  const double density = 0.5 * m.lame_lambda() * E.trace() * E.trace() + m.lame_mu() * E.squaredNorm();
  std::array<double, 2> error{};
  for (const std::size_t k : {0U, 1U}) {
    const int n = k == 0 ? 4 : 8;
    const Body body(shell(n, n, m, warped(0.05)));
    const Eigen::VectorXd u = on_nodes(body.mesh(), [&](const Vector3d& X) -> Vector3d { return H * X; });
    error[k] = std::abs(body.assembly.strain_energy(u) / (density * body.mesh().weight.sum()) - 1);
    note("warped " + std::to_string(n), error[k]);
  }
  EXPECT_LT(error[1], 1e-3);
  EXPECT_GT(error[0], 3 * error[1]);
}

// Six rigid motions and no other motion without energy, of one warped cell.
TEST(SolidShell, HasSixRigidMotionsAndNoSpuriousOnes) {
  for (const double t : {0.3, 0.001})
    for (const double poisson : {0.0, 0.3, 0.49}) {
      const Body body(shell(1, 1, elastic(1e6, poisson), warped(t)));
      const Eigen::MatrixXd K = body.assembly.tangent(Eigen::VectorXd::Zero(24));
      EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
      const Eigen::VectorXd values = eigenvalues_of(0.5 * (K + K.transpose()));
      EXPECT_LT(std::abs(values(5)), 1e-13 * values(23)) << t << " " << poisson;
      EXPECT_GT(values(6), 1e3 * std::abs(values(5))) << t << " " << poisson;
      EXPECT_GT(values(6), 0.02 * 1e6 * t * t * t) << "bending or twist";
    }
}

TEST(SolidShell, ARotationOfAnyAngleStoresNothing) {
  const Body body(shell(3, 3, elastic(1e6, 0.3, MaterialModel::saint_venant_kirchhoff), warped(0.01)));
  for (const double angle : {0.3, 1.9, 3.1}) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix() -
        Eigen::Matrix3d::Identity();
    const Eigen::VectorXd u = on_nodes(body.mesh(), [&](const Vector3d& X) -> Vector3d { return turn * X; });
    EXPECT_LT(body.assembly.strain_energy(u), 1e-24 * 1e6 * 0.01);
  }
}

// Force = gradient of the energy, tangent = derivative of the force, work of the mid-point = change of
// energy.
TEST(SolidShell, ForceTangentAndWorkAreThoseOfItsEnergy) {
  for (const auto model :
       {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff, MaterialModel::neo_hookean}) {
    const Body body(shell(2, 2, elastic(1e6, 0.3, model), warped(0.1)));
    const auto& [assembly, mesh] = std::tie(body.assembly, body.mesh());
    const Eigen::VectorXd way = on_nodes(mesh, [](const Vector3d& X) {
      return Vector3d(std::sin(9 * X.y()), std::cos(7 * X.x()), 30 * X.z() * X.y());
    });
    const Eigen::VectorXd u0 =
        on_nodes(mesh, [](const Vector3d& X) { return Vector3d(0.05 * X.y(), 0, 0.1 * X.x()); });
    const Eigen::VectorXd u1 = on_nodes(mesh, [](const Vector3d& X) {
      return Vector3d(0.05 * X.x() - 0.3 * X.z() * X.x(), -0.04 * X.y(),
                      0.2 * X.x() * X.x() - 0.1 * X.x() * X.y());
    });
    constexpr double h = 1e-6;
    const double slope =
        (assembly.strain_energy(u1 + h * way) - assembly.strain_energy(u1 - h * way)) / (2 * h);
    EXPECT_NEAR(assembly.internal_force(u1, u1, 0).dot(way) / slope, 1, 1e-6);
    for (const double alpha : {0.0, 0.5}) {
      // With added strains a term of third order is left out.
      if (model == MaterialModel::neo_hookean && alpha == 0.5) continue;
      const Eigen::VectorXd derivative = (assembly.internal_force(u0, u1 + h * way, alpha) -
                                          assembly.internal_force(u0, u1 - h * way, alpha)) /
                                         (2 * h);
      const Eigen::VectorXd tangent = (1 - alpha) * (assembly.tangent(u0, u1, alpha) * way);
      EXPECT_LT((tangent - derivative).norm(), 1e-6 * derivative.norm());
    }
    const Matrix K = assembly.tangent(u1);
    EXPECT_LT((K - Matrix(K.transpose())).norm(), 1e-12 * K.norm());
    const double change = assembly.strain_energy(u1) - assembly.strain_energy(u0);
    EXPECT_NEAR(assembly.internal_force(u0, u1, 0.5).dot(u1 - u0) / change, 1,
                model == MaterialModel::neo_hookean ? 1e-7 : 1e-11);
  }
}

/// A plate between z = 0 and a, x = 0 and a, thin along y, clamped all around.
Parameters clamped_plate(double a, double t, double poisson, int cells) {
  SolidBox plate =
      box("plate", {0, 0, 0}, {a, t, a},
          {.model = MaterialModel::linear, .density = 7800, .young = 2.1e11, .poisson = poisson});
  for (const std::size_t side : {0U, 1U, 4U, 5U}) plate.support[side] = Support::clamped;
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(3, {plate});
  p.surface_spacing = a;
  p.fem = {.degree = 1, .refinement = 0, .cell_size = a / cells, .strain = StrainField::solid_shell};
  return p;
}

// 0.00126532 q a⁴/D (Timoshenko & Woinowsky-Krieger 1959, table 35: 0.00126). Up to a thickness of a
// thousandth and to a material that keeps its volume.
TEST(SolidShell, AClampedPlateBendsAsThinPlateTheorySays) {
  constexpr double a = 1, q = 1;
  for (const double t : {0.01, 0.001})
    for (const double poisson : {0.3, 0.49}) {
      Parameters p = clamped_plate(a, t, poisson, 24);
      p.load = {.kind = LoadKind::traction, .value = {0, -q, 0}, .face = "top", .at = {}, .ramp = 0};
      FemSolver<3> solver(p);
      solver.solve_static();
      const double D = 2.1e11 * t * t * t / 12 / (1 - poisson * poisson);
      const double w = -solver.displacement_at({a / 2, 0, a / 2}).y();
      note("t " + std::to_string(t) + " nu " + std::to_string(poisson),
           w / (0.00126532 * q * std::pow(a, 4) / D));
      EXPECT_NEAR(w / (0.00126532 * q * std::pow(a, 4) / D), 1, 0.01) << t << " " << poisson;
    }
}

// ω a² √(ρt/D) of Leissa 1973, J. Sound Vib. 31:257.
TEST(SolidShell, AClampedPlateHasTheFrequenciesOfThinPlateTheory) {
  constexpr double a = 1, t = 0.005, poisson = 0.3;
  const std::vector<double> found = FemSolver<3>(clamped_plate(a, t, poisson, 32)).frequencies(4);
  const double scale = std::sqrt(2.1e11 * t * t / 12 / (1 - poisson * poisson) / 7800) / (2 * pi * a * a);
  const std::array<double, 4> leissa = {35.992, 73.413, 73.413, 108.27};
  for (std::size_t k = 0; k < 4; ++k) {
    note("f" + std::to_string(k + 1), found[k] / (leissa[k] * scale));
    EXPECT_NEAR(found[k] / (leissa[k] * scale), 1, 0.01) << k;
  }
}

// The elastica with P L²/EI = 10 (Mattiasson 1981, Int. J. Numer. Methods Eng. 17:145): the tip sinks by
// 0.81061 L and draws in by 0.55500 L.
TEST(SolidShell, AStripBendsByALargeAngleAsTheElastica) {
  constexpr double L = 1, t = 0.01, width = 0.05, young = 2.1e11;
  SolidBox strip =
      box("strip", {0, 0, 0}, {L, t, width},
          {.model = MaterialModel::saint_venant_kirchhoff, .density = 7800, .young = young, .poisson = 0});
  strip.support[0] = Support::clamped;
  Parameters p;
  p.dimension = 3;
  p.shape.kind = ShapeKind::solid;
  p.solid = solid_of_boxes(3, {strip});
  p.surface_spacing = L;
  p.fem = {.degree = 1, .refinement = 0, .cell_size = 0.05, .strain = StrainField::solid_shell};
  const double P = 10 * young * width * t * t * t / 12 / (L * L);
  p.load = {
      .kind = LoadKind::traction, .value = {0, -P / (width * t), 0}, .face = "right", .at = {}, .ramp = 0};
  FemSolver<3> solver(p);
  solver.solve_static();
  const Vector3d tip = solver.displacement_at({L, t / 2, width / 2});
  note("sinks", -tip.y() / L);
  note("draws in", -tip.x() / L);
  EXPECT_NEAR(-tip.y() / L, 0.81061, 0.003);
  EXPECT_NEAR(-tip.x() / L, 0.55500, 0.003);
}

// A quarter of the roof under its weight, 16 × 16 cells: 0.3024 at the middle of the free edge (MacNeal &
// Harder 1985, Finite Elem. Anal. Des. 1:3).
TEST(SolidShell, TheScordelisLoRoof) {
  constexpr double R = 25, L = 50, t = 0.25, angle = 40 * pi / 180;
  const Body body(shell(16, 16, elastic(4.32e8, 0), [](double s, double along, double z) {
    const double r = R + t * z;
    return Vector3d(r * std::sin(angle * s), 0.5 * L * along, r * std::cos(angle * s));
  }));
  const auto fixed = fixed_where(body.mesh(), [](const Vector3d& X, int k) {
    const bool crown = X.x()<1e-9, end = X.y()> 0.5 * L - 1e-9, middle = X.y() < 1e-9;
    return (crown && k == 0) || (middle && k == 1) || (end && k != 1);
  });
  Eigen::VectorXd weight =
      body.assembly.mass() * on_nodes(body.mesh(), [](const Vector3d&) { return Vector3d(0, 0, 1); });
  weight *= -90 / (1000 * t);
  const Eigen::VectorXd u = solve(body.assembly.tangent(0 * weight), fixed, weight);
  double lowest = 0;
  for (int i = 0; i < body.mesh().n_nodes(); ++i) lowest = std::min(lowest, u(3 * i + 2));
  note("roof", -lowest / 0.3024);
  EXPECT_NEAR(-lowest / 0.3024, 1, 0.02);
}

// A quarter of the hemisphere with a hole of 18 degrees, R/t = 250, 16 × 16 cells: 0.0940 (MacNeal & Harder
// 1985).
TEST(SolidShell, ThePinchedHemisphere) {
  constexpr double R = 10, t = 0.04;
  const Body body(shell(16, 16, elastic(6.825e7, 0.3), [](double s, double up, double z) {
    const double r = R + t * z, phi = s * pi / 2, theta = up * 72 * pi / 180;
    return Vector3d(r * std::cos(phi) * std::cos(theta), r * std::sin(phi) * std::cos(theta),
                    r * std::sin(theta));
  }));
  const Mesh<3>& mesh = body.mesh();
  // Symmetry; the height is held by one node of the equator.
  const auto fixed = fixed_where(mesh, [](const Vector3d& X, int k) {
    return (X.x() < 1e-9 && k == 0) || (std::abs(X.y()) < 1e-9 && k == 1) ||
           (k == 2 && X.z() < 1e-9 && X.y() < 1e-9 && X.x() > R);
  });
  Eigen::VectorXd force = Eigen::VectorXd::Zero(mesh.n_unknowns());
  std::vector<int> at_x;
  for (int i = 0; i < mesh.n_nodes(); ++i) {
    if (mesh.node(2, i) > 1e-9) continue;
    if (mesh.node(1, i) < 1e-9) force(3 * i) = 0.5, at_x.push_back(i);
    if (mesh.node(0, i) < 1e-9) force(3 * i + 1) = -0.5;
  }
  ASSERT_EQ(at_x.size(), 2U);
  const Eigen::VectorXd u = solve(body.assembly.tangent(0 * force), fixed, force);
  note("hemisphere", u(3 * at_x[0]) / 0.0940);
  EXPECT_NEAR(u(3 * at_x[0]) / 0.0940, 1, 0.03);
}

// σ = ± E κ t/2/(1−ν²) on the two faces of a plate that bends to a cylinder, linear between them.
TEST(SolidShell, StressesOnTheFacesAreThoseOfBending) {
  constexpr double t = 0.01, k = 0.01;
  const Body body(shell(4, 4, elastic(1e6, 0.3), distorted(t)));
  const Recovery<3> recovery(body.mesh());
  const Eigen::VectorXd u = on_nodes(body.mesh(), [](const Vector3d& X) {
    return Vector3d(-k * X.z() * X.x(), 0, 0.5 * k * X.x() * X.x());
  });
  Eigen::MatrixXd state(7, body.mesh().n_cells() * 8);
  for (int c = 0; c < body.mesh().n_cells(); ++c) state.middleCols(8 * c, 8) = body.assembly.cell_state(u, c);
  const Eigen::MatrixXd stress = recovery.on_nodes(state);
  const double S = 1e6 * k * t / 2 / 0.91;
  for (int i = 0; i < recovery.size(); ++i) {
    const double side = body.mesh().node(2, recovery.node()[static_cast<std::size_t>(i)]) > 0 ? -1 : 1;
    EXPECT_NEAR(stress(0, i), side * S, 1e-6 * S);
    EXPECT_NEAR(stress(3, i), side * 0.3 * S, 1e-6 * S);
    for (const int zero : {1, 2, 4, 5}) EXPECT_NEAR(stress(zero, i), 0, 1e-6 * S);
  }
}

TEST(SolidShell, FindsTheThinDirectionOfEachCellAndRefusesBlocks) {
  // A plate thin along y with a stiffener as thick as itself, thin along x: the cell where they meet is a
  // joint.
  const Discretisation<3> d(solid_of_boxes(3, {soft_box("plate", {0, 0, 0}, {1, 0.02, 1}),
                                               soft_box("rib", {0.5, 0.02, 0}, {0.52, 0.2, 1})}),
                            1, 0, 0.1);
  const std::vector<int> axes = thin_axes(d.mesh());
  for (int c = 0; c < d.mesh().n_cells(); ++c) {
    Vector3d middle = Vector3d::Zero();
    for (int a = 0; a < 8; ++a) middle += d.mesh().place(d.mesh().cell(a, c)) / 8;
    const int wanted = middle.y() > 0.02 ? 0 : std::abs(middle.x() - 0.51) < 0.01 ? -1 : 1;
    EXPECT_EQ(axes[static_cast<std::size_t>(c)], wanted) << middle.transpose();
  }
  EXPECT_NEAR(slenderness(d.mesh()), 5, 0.2);
  EXPECT_FALSE(has_core(d.mesh()));
  const Discretisation<3> block(solid_of_boxes(3, {soft_box("block", {0, 0, 0}, {1, 1, 1})}), 1, 0);
  try {
    thin_axes(block.mesh());
    FAIL() << "a block is no shell";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("cell 0 at (0.5, 0.5, 0.5) m"), std::string::npos) << e.what();
  }
}

TEST(SolidShell, TheLinesSayWhatWasChosenAndNameItWherePlatesAreThin) {
  const auto says = [](const Parameters& p, const std::string& part) {
    for (const std::string& line : FemSolver<3>(p).lines())
      if (line.find(part) != std::string::npos) return true;
    return false;
  };
  Parameters p = clamped_plate(1, 0.005, 0.3, 10);
  const std::string advice = "structure.fem.strain = \"solid_shell\" is made for such plates";
  EXPECT_TRUE(says(p, "solid shells: 100 cells, thin along their shortest edges, up to 20 times longer"));
  EXPECT_FALSE(says(p, advice));
  p.fem.strain = StrainField::automatic;
  EXPECT_TRUE(says(p, advice)) << "one cell through the thickness";
  p.fem.refinement = 1;
  EXPECT_TRUE(says(p, advice)) << "two cells";
  p.fem.refinement = 2;
  EXPECT_FALSE(says(p, advice)) << "four cells";
  p.fem = {.degree = 2, .refinement = 0, .cell_size = 0.2};
  EXPECT_TRUE(says(p, advice)) << "Q2 too";
}

}  // namespace solid_shell_test
}  // namespace strake::structure::fem
