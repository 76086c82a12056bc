#include "structure/body/beam.hpp"
#include "structure/fem/fem.hpp"
#include "structure/fem/solver.hpp"
#include "tests/method/structure/decrement.hpp"
#include "tests/method/structure/smooth_solution.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

namespace strake::structure::fem {
namespace fem_strip_test {

struct Strip {
  std::string name;
  double length;
  Support left, right;
  double deflection;  // [m] under q = 1e5 Pa at mid-height, middle (tip of the cantilever); 0: not given
  double frequency;   // [Hz]
};

/// Steel, 0.02 m thick, plane strain. Two-dimensional references of cases/VALIDATION.md, "Strips: deflection
/// and frequencies" (quadratic elements, extrapolated).
const Strip strips[] = {
    {"clamped_clamped", 0.4, Support::clamped, Support::clamped, 4.462e-5, 687.8},
    {"clamped_free", 0.4, Support::clamped, Support::free, 2.0822e-3, 109.72},
    {"pinned_pinned", 0.4, Support::pinned, Support::pinned, 2.181e-4, 306.9},
    {"clamped_clamped_short", 0.3, Support::clamped, Support::clamped, 0, 1207},
};

Parameters parameters(const Strip& strip, MaterialModel model = MaterialModel::saint_venant_kirchhoff) {
  Parameters p;
  p.plate = {.length = strip.length,
             .thickness = 0.02,
             .bottom = {0, 0, 0},
             .left = strip.left,
             .right = strip.right};
  p.material.model = model;
  return p;
}

void PrintTo(const Strip& strip, std::ostream* out) {
  *out << strip.name;
}

std::string name_of(const testing::TestParamInfo<Strip>& strip) {
  return strip.param.name;
}

/// Those with a static reference.
std::vector<Strip> loaded_strips() {
  std::vector<Strip> loaded;
  for (const Strip& strip : strips)
    if (strip.deflection > 0) loaded.push_back(strip);
  return loaded;
}

class StripOf : public testing::TestWithParam<Strip> {};
class LoadedStripOf : public testing::TestWithParam<Strip> {};
INSTANTIATE_TEST_SUITE_P(ValidationB1, StripOf, testing::ValuesIn(strips), name_of);
INSTANTIATE_TEST_SUITE_P(ValidationB1, LoadedStripOf, testing::ValuesIn(loaded_strips()), name_of);

TEST_P(StripOf, HasTheReferenceFrequencyWithinThreeTenthsOfAPercent) {
  const auto solver = make_solver(parameters(GetParam()));
  const double f1 = solver->frequencies(1).front();
  RecordProperty("f1", std::to_string(f1));
  EXPECT_NEAR(f1 / GetParam().frequency, 1, 0.003);
}

TEST_P(LoadedStripOf, HasTheReferenceDeflectionWithinThreeTenthsOfAPercent) {
  const Strip& strip = GetParam();
  Parameters p = parameters(strip, MaterialModel::linear);
  p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
  const auto solver = make_solver(p);
  solver->solve_static();
  const double x = strip.right == Support::free ? strip.length / 2 : 0;
  const double deflection = -solver->displacement_at({x, 0.01, 0}).y();
  RecordProperty("deflection", std::to_string(deflection * 1e6) + " um");
  EXPECT_NEAR(deflection / strip.deflection, 1, 0.003);
}

// cases/VALIDATION.md, "Strips: deflection and frequencies". Timoshenko's beam stands in where there is no
// two-dimensional reference; it is 0.26 % off at clamps.
TEST(FemStrip, HigherModesAreTimoshenkosAndRigidMotionsAreLeftOut) {
  for (const auto& [left, right] : {std::pair{Support::free, Support::free},
                                    {Support::pinned, Support::free},
                                    {Support::clamped, Support::free},
                                    {Support::clamped, Support::clamped}}) {
    const Parameters p = parameters({"", 0.4, left, right, 0, 0});
    const auto beam = beam_frequencies(p.plate, p.material, BeamTheory::timoshenko, 3);
    const auto f = make_solver(p)->frequencies(3);
    ASSERT_EQ(f.size(), 3U);
    const std::size_t like_a_beam = left == Support::pinned ? 1 : 3;
    for (std::size_t i = 0; i < like_a_beam; ++i) EXPECT_NEAR(f[i] / beam[i], 1, 0.006) << "mode " << i + 1;
  }
}

// cases/VALIDATION.md, "Plate under a column of water": the structure's side of the hydrostatic plate.
TEST(FemStrip, ThePlateUnderAWaterColumnHasItsReferences) {
  Parameters p;
  p.plate = {.length = 1,
             .thickness = 0.05,
             .bottom = {0, 0, 0},
             .left = Support::clamped,
             .right = Support::clamped};
  p.material = {
      .model = MaterialModel::saint_venant_kirchhoff, .density = 2700, .young = 67.5e9, .poisson = 0.34};
  p.gravity = {0, -9.81, 0};
  p.load = {.kind = LoadKind::traction, .value = {0, -19620, 0}, .face = "top", .at = {}, .ramp = 0};
  const auto solver = make_solver(p);
  EXPECT_NEAR(solver->frequencies(1).front() / 268.9, 1, 0.004);
  solver->solve_static();
  EXPECT_NEAR(solver->displacement_at({0, 0.025, 0}).y() / -7.066e-5, 1, 0.004);
}

// δ = 2πζ/√(1 − ζ²), ζ = ½(a/ω + bω). The strip is let go from a static deflection, of which its first mode
// is all but 3 %.
TEST(FemStrip, RayleighDampingTakesItsLogarithmicDecrement) {
  const Parameters at_rest = parameters(strips[1], MaterialModel::linear);
  Parameters bent = at_rest;
  bent.load = {.kind = LoadKind::traction, .value = {0, -1e5, 0}, .face = "top", .at = {}, .ramp = 0};
  FemSolver<2> shape(bent);
  const double omega = 2 * std::numbers::pi * shape.frequencies(1).front();
  shape.solve_static();
  constexpr double ratio = 0.02;
  for (const bool by_mass : {true, false}) {
    Parameters p = at_rest;
    (by_mass ? p.damping.mass : p.damping.stiffness) = by_mass ? 2 * ratio * omega : 2 * ratio / omega;
    FemSolver<2> solver(p);
    solver.set_unknowns(shape.unknowns(), Eigen::VectorXd::Zero(shape.unknowns().size()));
    const double measured = decrement_over_theory(solver, omega, ratio, {0.2, 0.01, 0});
    RecordProperty(by_mass ? "decrement_over_theory_mass" : "decrement_over_theory_stiffness",
                   std::to_string(measured));
    EXPECT_NEAR(measured, 1, 0.01);
  }
}

// cases/VALIDATION.md, "Oscillating plate": T = 0.2552 s by plane elasticity.
TEST(FemStrip, TheSoftOscillatingPlateHasItsReferencePeriod) {
  Parameters p;
  p.plate = {.length = 0.2,
             .thickness = 0.02,
             .bottom = {0, 0, 0},
             .left = Support::clamped,
             .right = Support::free};
  p.material.density = 1000;
  p.material.young = 1.99845e6;
  p.material.poisson = 0.39752;
  EXPECT_NEAR(0.2552 * make_solver(p)->frequencies(1).front(), 1, 0.004);
}

// cases/VALIDATION.md, "Elastic plate: first bending": a plate at speed V whose ends are stopped. The
// references are of the beam, whose f1 is off by 1.6 %.
TEST(FemStrip, AStoppedPlateBendsAsFarAsTheBeamInItsFirstPeak) {
  for (const auto& [support, reference, until] :
       {std::tuple{Support::clamped, 0.3049e-3, 7e-4}, {Support::pinned, 0.6571e-3, 1.4e-3}}) {
    Parameters p = parameters({"", 0.4, support, support, 0, 0});
    FemSolver<2> solver(p);
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
    for (Eigen::Index i = 1; i < velocity.size(); i += 2) velocity(i) = -1;
    solver.set_unknowns(0 * velocity, velocity);
    double peak = 0;
    for (double t = 0; t < until; t += 1e-5) {
      solver.advance(t, 1e-5, Load());
      peak = std::max(peak, -solver.displacement_at({0, 0.01, 0}).y());
    }
    EXPECT_NEAR(peak / reference, 1, 0.025);
  }
}

/// Mid deflection [m] of a plate that a pressure bends, risen smoothly within 1 ms.
double pushed(double dt, int steps, double rho, MaterialModel model) {
  Parameters p = parameters(strips[0], model);
  p.fem.refinement = 2;
  p.fem.rho_infinity = rho;
  p.load = {.kind = LoadKind::traction, .value = {0, -5e6, 0}, .face = "top", .at = {}, .ramp = 1e-3};
  FemSolver<2> solver(p);
  for (int i = 0; i < steps; ++i) solver.advance(i * dt, dt, Load());
  return solver.displacement_at({0, 0.01, 0}).y();
}

TEST(FemTime, IsOfSecondOrder) {
  for (const double rho : {1.0, 0.8})
    for (const auto model : {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff}) {
      const double coarse = pushed(2e-5, 40, rho, model), middle = pushed(1e-5, 80, rho, model),
                   fine = pushed(5e-6, 160, rho, model);
      EXPECT_NEAR(std::log2((coarse - middle) / (middle - fine)), 2, 0.15) << "rho_infinity " << rho;
    }
}

TEST(FemTime, KeepsTheEnergyOfAThousandStepsOfLargeVibration) {
  for (const auto model : {MaterialModel::linear, MaterialModel::saint_venant_kirchhoff}) {
    Parameters p = parameters(strips[0], model);
    p.fem.refinement = 1;
    FemSolver<2> solver(p);
    Eigen::VectorXd velocity = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
    for (Eigen::Index i = 1; i < velocity.size(); i += 2) velocity(i) = -20;
    solver.set_unknowns(0 * velocity, velocity);
    const double start = solver.energy().kinetic;
    double drift = 0;
    for (int i = 0; i < 1000; ++i) {
      solver.advance(i * 1e-5, 1e-5, Load());
      const Energy e = solver.energy();
      drift = std::max(drift, std::abs(e.kinetic + e.strain - start));
    }
    RecordProperty("drift", std::to_string(drift / start * 1e12) + "e-12");
    EXPECT_LT(drift, 1e-9 * start);  // Newton's tolerance 1e-10 per step, errors of both signs
  }
}

TEST(FemTime, DampsHighFrequenciesAloneBelowRhoOne) {
  Parameters p = parameters(strips[0], MaterialModel::linear);
  p.fem.refinement = 2;
  p.fem.rho_infinity = 0.5;
  const double smooth = pushed(1e-5, 290, 0.5, MaterialModel::linear);  // two periods of mode 1
  const double undamped = pushed(1e-5, 290, 1, MaterialModel::linear);
  EXPECT_NEAR(smooth / undamped, 1, 0.01);
  FemSolver<2> solver(p);
  Eigen::VectorXd rough = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
  for (Eigen::Index i = 0; i < rough.size(); i += 3) rough(i) = 1;  // nodes in disorder
  solver.set_unknowns(0 * rough, rough);
  const double start = solver.energy().kinetic;
  for (int i = 0; i < 300; ++i) solver.advance(i * 1e-5, 1e-5, Load());
  EXPECT_LT(solver.energy().kinetic + solver.energy().strain, 0.5 * start);
}

// Free in space, spinning through a whole turn in steps of 0.05 rad: rotations are large, and nothing is
// lost.
TEST(FemTime, ASpinningFreePlateKeepsEnergyAndAngularMomentum) {
  Parameters p = parameters({"", 0.4, Support::free, Support::free, 0, 0});
  p.fem.refinement = 1;
  FemSolver<2> solver(p);
  const Mesh<2>& mesh = solver.mesh();
  const Matrix mass = Assembly<2>(mesh, elastic_solid(p).parts).mass();
  constexpr double spin = 1000;  // [rad/s]
  Eigen::VectorXd velocity(mesh.n_unknowns());
  for (int i = 0; i < mesh.n_nodes(); ++i)
    velocity.segment<2>(2 * i) << -spin * (mesh.node(1, i) - 0.01), spin * mesh.node(0, i);
  solver.set_unknowns(0 * velocity, velocity);
  const auto angular_momentum = [&] {
    const Frame frame = solver.frame();
    Eigen::VectorXd v(mesh.n_unknowns()), turned(mesh.n_unknowns());
    for (int i = 0; i < mesh.n_nodes(); ++i) {
      v.segment<2>(2 * i) = frame.point_data[1].value.col(i).head<2>();
      turned.segment<2>(2 * i) << -(frame.position(1, i) - 0.01), frame.position(0, i);
    }
    return turned.dot(mass * v);
  };
  const double energy = solver.energy().kinetic, momentum = angular_momentum();
  EXPECT_NEAR(energy / (0.5 * momentum * spin), 1, 1e-12);
  double energy_drift = 0, momentum_drift = 0;
  for (int i = 0; i < 126; ++i) {
    solver.advance(i * 5e-5, 5e-5, Load());
    energy_drift =
        std::max(energy_drift, std::abs(solver.energy().kinetic + solver.energy().strain - energy));
    momentum_drift = std::max(momentum_drift, std::abs(angular_momentum() - momentum));
  }
  EXPECT_LT(energy_drift, 1e-8 * energy);
  EXPECT_LT(momentum_drift, 1e-8 * momentum);
}

// The coupling of cases/VALIDATION.md, "Piston and column", with the simplest fluid, a mass m on each
// interface point. It follows the interface with v1 = 2(x1 − x0)/dt − v0 and returns the window mean −m (v1 −
// v0)/dt. Together that is the trapezoidal rule, which conserves energy.
TEST(FemTime, AnAddedMassOnTheInterfaceKeepsTheEnergyOfTheWhole) {
  Parameters p = parameters(strips[0]);
  p.fem.refinement = 1;
  FemSolver<2> solver(p);
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(solver.mesh().n_unknowns());
  for (Eigen::Index i = 1; i < velocity.size(); i += 2) velocity(i) = -5;
  solver.set_unknowns(0 * velocity, velocity);
  const Eigen::Index n = solver.interface().position.cols();
  const double mass = 0.3 * 62.4 / static_cast<double>(n);  // [kg]
  constexpr double dt = 1e-5;
  Points x0 = solver.displacement(), v0 = solver.velocity();
  const double start = solver.energy().kinetic + 0.5 * mass * v0.squaredNorm();
  double drift = 0, work = 0;
  for (int i = 0; i < 80; ++i) {
    solver.save();
    Points force = Points::Zero(3, n), v1;
    double change = 1;
    for (int k = 0; change > 1e-11 && k < 60; ++k) {
      solver.restore();
      solver.advance(i * dt, dt, Load({Sample{i * dt, {{"force", "N", true, force}}}}));
      v1 = (2 / dt) * (solver.displacement() - x0) - v0;
      const Points next = -(mass / dt) * (v1 - v0);
      change = (next - force).norm() / next.norm();
      force = next;
    }
    EXPECT_LE(change, 1e-11);
    EXPECT_LT((v1 - solver.velocity()).norm(), 1e-8 * v1.norm()) << "both sides have one velocity";
    x0 = solver.displacement();
    v0 = v1;
    const Energy e = solver.energy();
    work = std::max(work, std::abs(e.external));
    drift = std::max(drift, std::abs(e.kinetic + e.strain + 0.5 * mass * v1.squaredNorm() - start));
  }
  EXPECT_GT(work, 0.05 * start) << "the masses must matter";
  EXPECT_LT(drift, 1e-8 * start);
}

TEST(FemSpace, ConvergesOnASmoothSolutionWithOneOrderMoreThanItsDegree) {
  // The 32 cells along the length stay; 4 and 8 through the thickness set the error.
  for (const int degree : {1, 2}) {
    const double order = std::log2(error_of_smooth_solution(degree, 2) / error_of_smooth_solution(degree, 3));
    RecordProperty("order_Q" + std::to_string(degree), std::to_string(order));
    EXPECT_NEAR(order, degree + 1, 0.15);
  }
}

}  // namespace fem_strip_test
}  // namespace strake::structure::fem
