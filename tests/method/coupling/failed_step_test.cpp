#include "coupler/coupling/scheme.hpp"
#include "coupler/coupling/window_loop.hpp"
#include "proto/error.hpp"
#include "structure/body/surface.hpp"
#include "structure/fem/fem.hpp"
#include "structure/participant.hpp"
#include "structure/particle/solver.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

// What becomes of a window that a structure cannot take.

namespace strake {
namespace {

using structure::Parameters;
using structure::StructureParticipant;

/// Water that presses on a body however it moves: for a while, and on every point by its length.
class Blow : public models::Model<double> {
 public:
  Blow(const InterfaceMesh& body, double pressure, double until)
      : size_(structure::point_sizes(body)), pressure_(pressure), until_(until) {
    InterfaceMesh mesh = body;
    mesh.name = "fluid";
    begin(std::move(mesh), 0);
  }

 private:
  Advanced step(const Window& window, const Input&) override {
    const double share = std::clamp((until_ - window.t) / window.dt, 0.0, 1.0);
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, size_.size());
    force.row(1) = -share * pressure_ * size_;
    Advanced advanced;
    advanced.output = {{"force", "N", true, force}};
    return advanced;
  }
  Eigen::VectorXd size_;
  double pressure_, until_;  // [Pa], [s]
};

constexpr double end = 0.012, blow_until = 1e-3;  // [s]
// An impact that needs shorter windows than 6 ms [Pa]. Half of it did, while Newton's method had one start.
constexpr double hard = 1.5e5;

Parameters rubber_strip() {
  Parameters p;
  p.plate = {.length = 0.1, .thickness = 0.01, .bottom = {0, 0, 0}};
  p.plate.left = structure::Support::clamped;
  p.plate.right = structure::Support::free;
  p.material = {
      .model = structure::MaterialModel::neo_hookean, .density = 1000, .young = 1e6, .poisson = 0.3};
  p.surface_spacing = 0.005;
  p.fem.refinement = 1;
  p.particle.spacing = 0.0025;
  return p;
}

CommonKeys tip() {
  CommonKeys common;
  ProbeKeys probe;
  probe.name = "tip";
  probe.of = "structure";
  probe.at = {0.05, 0.005, 0};
  probe.quantity = "displacement";
  common.probes = {probe};
  return common;
}

std::unique_ptr<StructureParticipant> strip(const std::string& kind, const Parameters& p) {
  auto solver = kind == "fem" ? structure::fem::make_solver(p) : structure::make_particle_solver(p);
  return std::make_unique<StructureParticipant>(std::move(solver), p, tip(), Setup{});
}

Input force_on(const InterfaceMesh& mesh, double size) {
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, mesh.position.cols());
  force.row(1).setConstant(size);
  return {{{0, {{"force", "N", true, force}}}}};
}

/// Result of a run of the strip under an impact.
struct Outcome {
  double deepest = 0, drift = 0;  // [m], 1
  int taken_back = 0;
  std::string why;
};

enum class Coupling { serial, parallel, explicit_ };

Outcome run(const std::string& kind, double pressure, double window, Coupling coupling = Coupling::serial,
            WindowControl control = {}, double safety = 0.8) {
  Parameters p = rubber_strip();
  p.particle.safety = safety;
  const auto body = strip(kind, p);
  Blow water(body->mesh(), pressure, blow_until);
  SchemeParameters parameters;
  parameters.parallel = coupling == Coupling::parallel;
  if (coupling == Coupling::explicit_) parameters.convergence.max_iterations = 1;
  Scheme scheme(water, *body, FieldTransfer(identity(body->mesh(), water.mesh())), parameters);
  WindowLoop loop(scheme, {.end = end, .window = window, .output_every = 0, .control = control});
  Outcome result;
  while (!loop.finished()) {
    const CommittedWindow done = loop.next();
    result.taken_back += done.taken_back;
    if (done.taken_back > 0) result.why = done.why;
    result.deepest = std::min(result.deepest, done.report.structure.at("tip.y"));
    result.drift = done.report.structure.at("check.structure_energy_drift");
  }
  EXPECT_EQ(loop.time(), end);
  return result;
}

TEST(FailedStep, AWindowThatNewtonCannotTakeIsHalvedAndTheRunReachesItsEnd) {
  EXPECT_EQ(run("fem", hard / 2, 2.5e-5).taken_back, 0);
  const Outcome fine = run("fem", hard, 5e-4);
  for (const Coupling coupling : {Coupling::serial, Coupling::parallel, Coupling::explicit_}) {
    const Outcome rough = run("fem", hard, 6e-3, coupling);
    EXPECT_GT(rough.taken_back, 0);
    EXPECT_NE(rough.why.find("the structure asks for a shorter window"), std::string::npos) << rough.why;
    // Which of the two comes last depends on the rounding of the processor's own instructions.
    EXPECT_TRUE(rough.why.find("Newton's method did not converge") != std::string::npos ||
                rough.why.find("a cell is turned inside out") != std::string::npos)
        << rough.why;
    EXPECT_NEAR(rough.deepest / fine.deepest, 1, 0.1);
    EXPECT_LT(rough.drift, 1e-8);
  }
}

// Results of rewound iterations appear only in the account of costs.
TEST(FailedStep, LeavesNoTraceInTheState) {
  for (const char* kind : {"fem", "particle"}) {
    const auto tried = strip(kind, rubber_strip()), untouched = strip(kind, rubber_strip());
    const Input load = force_on(tried->mesh(), 1), far_too_much = force_on(tried->mesh(), 1e200);
    for (const auto* body : {&tried, &untouched}) {
      (*body)->advance({0, 1e-4}, load);
      (*body)->commit(false);
    }
    const Advanced answer = tried->advance({1e-4, 1e-4}, far_too_much);
    EXPECT_TRUE(answer.retry_smaller_dt) << kind;
    EXPECT_EQ(answer.dt_limit, 5e-5);
    EXPECT_FALSE(answer.why.empty());
    EXPECT_NE(answer.fix.find("coupling.surface.window"), std::string::npos);
    tried->rewind();
    const Advanced a = tried->advance({1e-4, 5e-5}, load), b = untouched->advance({1e-4, 5e-5}, load);
    EXPECT_FALSE(a.retry_smaller_dt);
    EXPECT_EQ(a.output.at(0).value, b.output.at(0).value);
    for (const auto& [name, value] : b.monitor) {
      if (name == "seconds.step" || name == "memory.peak" || name == "count.steps") continue;
      EXPECT_EQ(a.monitor.at(name), value) << name;
    }
  }
}

TEST(FailedStep, EndsTheRunWithWhatWasTriedWhereNoWindowIsShortEnough) {
  const auto error_of = [](const char* kind, WindowControl control) {
    try {
      run(kind, 1e200, 1e-3, Coupling::serial, control);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::solver_fault);
      return to_text(error);
    }
    return std::string("no error");
  };
  for (const char* kind : {"fem", "particle"}) {
    const std::string halved = error_of(kind, {}), fixed = error_of(kind, {.smallest = 1e-3});
    EXPECT_NE(halved.find("window 1 (t = 0 s): the structure asks for a shorter window than"),
              std::string::npos)
        << halved;
    EXPECT_NE(halved.find("20 windows were tried, of 0.001 to 1.91e-09 s; the smallest is 1e-09 s"),
              std::string::npos)
        << halved;
    EXPECT_NE(halved.find("look at the load"), std::string::npos) << halved;
    EXPECT_NE(fixed.find("a window of 0.001 s was tried; the smallest is 0.001 s"), std::string::npos)
        << fixed;
    EXPECT_NE(fixed.find("lower coupling.surface.shorter.smallest"), std::string::npos) << fixed;
  }
}

// Twice the stable step: the solver halves its sub-steps itself, without the coupling.
TEST(FailedStep, SubStepsThatAreUnstableAreHalvedInsideTheWindow) {
  const Outcome stable = run("particle", 2e4, 1e-3);
  const Outcome unstable = run("particle", 2e4, 1e-3, Coupling::serial, {}, 2);
  EXPECT_EQ(unstable.taken_back, 0);
  EXPECT_NEAR(unstable.deepest / stable.deepest, 1, 0.01);
  EXPECT_LT(unstable.drift, 0.05);
}

}  // namespace
}  // namespace strake
