// CalculiX as an independent reference, on the same mesh under the same load.
#include "tests/method/structure/calculix.hpp"

#include "structure/body/surface.hpp"
#include "structure/fem/fem.hpp"
#include "tests/structure/body/boxes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake::structure {
namespace {

ProbeKeys probe(const std::string& name, const Eigen::Vector3d& at) {
  return {.name = name, .of = "structure", .at = at, .quantity = "deflection", .diameter = 0};
}

const deck::Story story{.title = "test", .origin = "tests"};

SolidBox box(const std::string& name, double x0, double y0, double x1, double y1) {
  SolidBox b;
  b.name = name;
  b.min = {x0, y0, 0};
  b.max = {x1, y1, 0};
  b.material = {.model = MaterialModel::linear, .density = 7800, .young = 2.1e11, .poisson = 0.3};
  return b;
}

Parameters body(int dimension, const std::vector<SolidBox>& boxes, int refinement) {
  return body_of_boxes(dimension, boxes, refinement, 0.01);
}

/// Static deflection by both.
struct Deflections {
  Eigen::Vector3d fem, calculix;
  double gap() const { return (fem - calculix).norm() / fem.norm(); }
};

Deflections solve(Parameters p, const Eigen::Vector3d& at) {
  p.analysis = Analysis::statics;
  const std::unique_ptr<Solver> solver = fem::make_solver(p);
  solver->solve_static();
  const deck::Model model = fem::model(p, {probe("at", at)});
  const auto printed = run_calculix(model, deck::calculix(model, std::nullopt, story));
  const bool found = !printed.front().empty();
  return {solver->displacement_at(at), found ? printed.front().back() : Eigen::Vector3d::Zero()};
}

Parameters strip(MaterialModel model, double traction, int refinement = 2) {
  SolidBox b = box("strip", 0, 0, 1, 0.1);
  b.material.model = model;
  b.support[0] = Support::clamped;
  Parameters p = body(2, {b}, refinement);
  p.load = {.kind = LoadKind::traction, .value = {0, traction, 0}, .face = "top", .at = {}, .ramp = 0};
  return p;
}

TEST(Calculix, AStripBendsAlikeInPlaneStrain) {
  STRAKE_NEEDS_CALCULIX();
  const double coarse = solve(strip(MaterialModel::linear, -1e5, 1), {1, 0.05, 0}).gap();
  const double fine = solve(strip(MaterialModel::linear, -1e5, 2), {1, 0.05, 0}).gap();
  RecordProperty("gap", std::to_string(fine));
  EXPECT_LT(fine, 1e-3);
  EXPECT_LT(fine, 0.7 * coarse) << "what is left is the mesh's: our elements have one node more";
}

TEST(Calculix, AStripBendsAlikeInPlaneStress) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = strip(MaterialModel::linear, -1e5);
  for (Part& part : p.solid.parts) part.material.plane_stress = true;
  const Deflections d = solve(p, {1, 0.05, 0});
  EXPECT_LT(d.gap(), 1e-3);
  EXPECT_GT(d.fem.norm(), 1.05 * solve(strip(MaterialModel::linear, -1e5), {1, 0.05, 0}).fem.norm())
      << "the two states differ";
}

// A tip that moves by a third of the length: both are Saint Venant-Kirchhoff in the reference configuration.
TEST(Calculix, AStripBendsAlikeFarOut) {
  STRAKE_NEEDS_CALCULIX();
  const Deflections d = solve(strip(MaterialModel::saint_venant_kirchhoff, -6e7), {1, 0.05, 0});
  EXPECT_LT(d.gap(), 2e-3);
  EXPECT_GT(d.fem.norm(), 0.3);
  const Deflections linear = solve(strip(MaterialModel::linear, -6e7), {1, 0.05, 0});
  EXPECT_GT((linear.fem - d.fem).norm(), 0.02 * d.fem.norm()) << "not the linear answer";
}

TEST(Calculix, GravityActsAlike) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = strip(MaterialModel::linear, 0);
  p.load.kind = LoadKind::none;
  p.gravity = {0, -9.81, 0};
  EXPECT_LT(solve(p, {1, 0.05, 0}).gap(), 1e-3);
}

TEST(Calculix, ASlabInSpaceBendsAlike) {
  STRAKE_NEEDS_CALCULIX();
  SolidBox b = box("slab", 0, 0, 1, 0.1);
  b.max.z() = 0.4;
  b.support[0] = Support::clamped;
  Parameters p = body(3, {b}, 1);
  p.surface_spacing = 0.1;
  p.load = {.kind = LoadKind::traction, .value = {0, -1e5, 1e4}, .face = "top", .at = {}, .ramp = 0};
  EXPECT_LT(solve(p, {1, 0.05, 0.2}).gap(), 5e-3);
}

// A ship's cross-section, 0.3 × 0.08 m, with bottom, sides and deck of 5 mm. It is supported at the upper
// ends of its sides, and has none, one or three ribs between bottom and deck.
TEST(Calculix, ABoxWithRibsBendsAlikeAndLessWithEachRib) {
  STRAKE_NEEDS_CALCULIX();
  constexpr double t = 0.005;
  std::vector<double> deflection;
  for (const int ribs : {0, 1, 3}) {
    std::vector<SolidBox> boxes = {box("bottom", -0.15, 0, 0.15, t), box("deck", -0.15, 0.08 - t, 0.15, 0.08),
                                   box("left", -0.15, t, -0.15 + t, 0.08 - t),
                                   box("right", 0.15 - t, t, 0.15, 0.08 - t)};
    boxes[1].support[0] = boxes[1].support[1] = Support::clamped;
    for (int r = 0; r < ribs; ++r) {
      const double x = -0.15 + 0.3 * (r + 1) / (ribs + 1);
      boxes.push_back(box("rib" + std::to_string(r), x - t / 2, t, x + t / 2, 0.08 - t));
    }
    Parameters p = body(2, boxes, 1);
    p.load = {.kind = LoadKind::traction, .value = {0, 1e5, 0}, .face = "bottom", .at = {}, .ramp = 0};
    const Deflections d = solve(p, {0, 0, 0});
    EXPECT_LT(d.gap(), 0.01) << ribs << " ribs";
    deflection.push_back(d.fem.y());
  }
  EXPECT_LT(deflection[1], deflection[0]);
  EXPECT_LT(deflection[2], deflection[1]);
}

/// A recorded load like that of a plate's water entry. From `contact` on a pressure on the lower face decays;
/// it is larger in the middle than at the ends.
struct Recorded {
  std::vector<Window> windows;
  std::vector<Points> force;
};

Recorded entry(const InterfaceMesh& mesh, int n, double dt) {
  constexpr double contact = 2e-4, decay = 2e-4, peak = 9e6;  // [s], [s], [Pa]
  Recorded record;
  const Eigen::VectorXd size = point_sizes(mesh);
  const double lowest = mesh.position.row(1).minCoeff();
  for (int w = 0; w < n; ++w) {
    const double t = w * dt, age = t + dt / 2 - contact;
    Points force = Points::Zero(3, mesh.position.cols());
    for (Eigen::Index i = 0; i < force.cols(); ++i)
      if (age > 0 && mesh.position(1, i) < lowest + 1e-9)
        force(1, i) = peak * std::exp(-age / decay) * std::cos(5 * mesh.position(0, i)) * size(i);
    record.windows.push_back({t, dt});
    record.force.push_back(force);
  }
  return record;
}

/// Deflection of a probe at the end of each window by both; how far they are apart in L2.
struct Histories {
  std::vector<double> fem, calculix;
  double largest() const {
    double most = 0;
    for (const double u : fem) most = std::max(most, std::abs(u));
    return most;
  }
  double gap() const {
    double difference = 0, scale = 0;
    for (std::size_t w = 0; w < fem.size(); ++w) {
      difference += std::pow(calculix[w] - fem[w], 2);
      scale += std::pow(fem[w], 2);
    }
    return std::sqrt(difference / scale);
  }
};

Histories follow(const Parameters& p, const Recorded& record, const ProbeKeys& at) {
  Histories result;
  const std::unique_ptr<Solver> solver = fem::make_solver(p);
  for (std::size_t w = 0; w < record.windows.size(); ++w) {
    const Window& window = record.windows[w];
    solver->advance(
        window.t, window.dt,
        Load({{.time = window.t + window.dt, .fields = {{"force", "N", true, record.force[w]}}}}));
    result.fem.push_back((solver->displacement_at(at.at) - p.velocity * (window.t + window.dt)).y());
  }
  const deck::Model model = fem::model(p, {at});
  const deck::LoadHistory history = deck::nodal_history(model, record.windows, record.force);
  const auto printed = run_calculix(model, deck::calculix(model, history, story));
  for (const Eigen::Vector3d& u : printed.front()) result.calculix.push_back(u.y());
  return result;
}

TEST(Calculix, APlateStruckByARecordedLoadMovesAlike) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = entering_plate();
  p.fem.refinement = 1;
  const Histories mid = follow(p, entry(surface(p), 100, 2e-5), probe("mid", {0, 0.012, 0}));
  ASSERT_EQ(mid.calculix.size(), mid.fem.size());
  EXPECT_LT(mid.gap(), 0.01);
  EXPECT_GT(mid.largest(), 5e-4) << "a deflection worth the name";
  RecordProperty("gap", std::to_string(mid.gap()));
}

// A load that is suddenly there, windows of two lengths, Rayleigh damping of both kinds.
TEST(Calculix, ADampedStripSwingsAlikeInWindowsOfTwoLengths) {
  STRAKE_NEEDS_CALCULIX();
  Parameters p = strip(MaterialModel::linear, -1e5, 1);
  p.damping = {.mass = 100, .stiffness = 1e-4};
  const Eigen::Index n = surface(p).position.cols();
  Recorded record;
  for (double t = 0; record.windows.size() < 120;) {
    record.windows.push_back({t, record.windows.size() < 60 ? 2e-4 : 1e-4});
    record.force.push_back(Points::Zero(3, n));
    t += record.windows.back().dt;
  }
  const ProbeKeys tip = probe("tip", {1, 0.05, 0});
  const Histories damped = follow(p, record, tip);
  ASSERT_EQ(damped.calculix.size(), damped.fem.size());
  EXPECT_LT(damped.gap(), 0.01);
  RecordProperty("gap", std::to_string(damped.gap()));
  p.damping = {};
  EXPECT_GT(follow(p, record, tip).largest(), 1.1 * damped.largest()) << "the damping is felt";
}

}  // namespace
}  // namespace strake::structure
