#include "coupler/coupling/scheme.hpp"

#include "proto/error.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace scheme_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double dt = 0.01;

/// Returns a linear function of its input, and records its calls.
class Scripted : public models::Model<double> {
 public:
  std::string calls;  // A advance, R rewind, C commit
  std::vector<Sample> told;
  std::function<Advanced(const Window&, const Input&)> answer;
  Scripted(const std::string& name, Eigen::Index n, std::vector<Field> initial = {}) {
    description_.initial = std::move(initial);
    begin(models::line_of_points(name, n), 0);
  }
  void prescribe() { description_.prescribed = true; }
  void rewind() override { calls += 'R'; }
  void commit(bool) override { calls += 'C'; }

 private:
  Advanced step(const Window& window, const Input& input) override {
    calls += 'A';
    if (!input.samples.empty()) told.push_back(input.samples.front());
    return answer(window, input);
  }
};

/// A body that moves with a velocity of its own whatever the load, under a fluid with some force.
struct Rigid {
  Scripted fluid{"fluid", 3}, structure;
  double x = 0;
  explicit Rigid(double speed, bool sends_velocity = false)
      : structure("structure", 3,
                  {models::y_field("displacement", "m", VectorXd::Zero(3)),
                   models::y_field("velocity", "m/s", VectorXd::Constant(3, speed))}) {
    fluid.answer = [](const Window&, const Input&) {
      Advanced a;
      a.output = {models::y_field("force", "N", VectorXd::LinSpaced(3, 1, 5))};
      a.monitor = {{"p_mid", 7}, {"seconds.pressure", 1}};
      a.dt_limit = 0.02;
      return a;
    };
    structure.answer = [speed, sends_velocity](const Window& w, const Input&) {
      Advanced a;
      a.output = {models::y_field("displacement", "m", VectorXd::Constant(3, speed * (w.t + w.dt)))};
      if (sends_velocity)
        a.output.push_back(models::y_field("velocity", "m/s", VectorXd::Constant(3, speed)));
      a.monitor = {{"mid.y", 3}, {"memory.peak", 5}};
      return a;
    };
  }
  Scheme scheme(SchemeParameters parameters = {}) {
    return Scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), parameters);
  }
};

TEST(Scheme, TakesOneIterationPerWindowForRigidMotion) {
  for (const bool velocity : {false, true}) {
    Rigid rigid(-6.26, velocity);
    Scheme scheme = rigid.scheme();
    for (int w = 0; w < 5; ++w) {
      const WindowReport report = scheme.advance({w * dt, dt});
      EXPECT_EQ(report.iterations, 1);
      EXPECT_TRUE(report.converged);
      EXPECT_LE(report.residual, 1e-15);
      EXPECT_EQ(report.number, w + 1);
      scheme.commit(false);
    }
    EXPECT_EQ(rigid.fluid.calls, "ACACACACAC");
    EXPECT_EQ(rigid.structure.calls, "ACACACACAC");
    EXPECT_DOUBLE_EQ(rigid.fluid.told.back().time, 5 * dt);
    EXPECT_NEAR(find(rigid.fluid.told.back().fields, "velocity")->value(1, 0), -6.26, 1e-11);
  }
}

TEST(Scheme, FindsTheVelocityOfABodyThatMovesFromTheStartAndDoesNotSaySo) {
  for (const double speed : {-6.26, 0.0}) {
    Rigid rigid(0);
    constexpr double g = -9.81;
    rigid.structure.answer = [speed](const Window& w, const Input&) {
      const double t = w.t + w.dt;
      Advanced a;
      a.output = {models::y_field("displacement", "m", VectorXd::Constant(3, speed * t + g * t * t / 2))};
      return a;
    };
    Scheme scheme = rigid.scheme();
    for (int w = 0; w < 6; ++w) {
      scheme.advance({w * dt, dt});
      scheme.commit(false);
      if (w < 2) continue;
      EXPECT_NEAR(find(rigid.fluid.told.back().fields, "velocity")->value(1, 0), speed + g * (w + 1) * dt,
                  1e-9)
          << "window " << w + 1;
    }
  }
}

/// A body that a table drives, with u = t³, which no parabola follows.
struct Driven : Rigid {
  Driven() : Rigid(0) {
    structure.answer = [](const Window& w, const Input& input) {
      const double t = w.t + w.dt;
      Advanced a;
      a.output = {models::y_field("displacement", "m", VectorXd::Constant(3, t * t * t)),
                  models::y_field("velocity", "m/s", VectorXd::Constant(3, 3 * t * t))};
      a.monitor = {{"body.fy", find(input.samples.back().fields, "force")->value.row(1).sum()}};
      return a;
    };
  }
};

TEST(Scheme, GivesTheFluidTheVeryMotionThatAStructureHasWhateverTheLoad) {
  for (const bool says_so : {false, true}) {
    Driven body;
    if (says_so) body.structure.prescribe();
    Scheme scheme = body.scheme();
    int most = 0;
    for (int w = 0; w < 6; ++w) {
      const WindowReport report = scheme.advance({w * dt, dt});
      most = std::max(most, report.iterations);
      EXPECT_EQ(report.structure.at("body.fy"), 9);
      scheme.commit(false);
    }
    EXPECT_EQ(most > 1, !says_so);
    if (!says_so) continue;
    EXPECT_EQ(body.fluid.calls, "ACACACACACAC");
    EXPECT_EQ(body.structure.calls, "ARACARACARACARACARACARAC");
    const double t = 5 * dt + dt;
    EXPECT_EQ(find(body.fluid.told.back().fields, "displacement")->value(1, 0), t * t * t);
    EXPECT_EQ(find(body.fluid.told.back().fields, "velocity")->value(1, 0), 3 * t * t);
  }
}

TEST(Scheme, TakesAPrescribedStructureBackThatWantsAShorterWindow) {
  Driven body;
  body.structure.prescribe();
  body.structure.answer = [](const Window&, const Input&) {
    Advanced a;
    a.retry_smaller_dt = true;
    a.dt_limit = 0.3 * dt;
    return a;
  };
  Scheme scheme = body.scheme();
  const WindowReport report = scheme.advance({0, dt});
  EXPECT_TRUE(report.retry);
  EXPECT_EQ(report.dt_limit, 0.3 * dt);
  EXPECT_EQ(body.structure.calls, "AR");
  EXPECT_EQ(body.fluid.calls, "");
}

TEST(Scheme, ReportsWorkForceMonitorsAndTheShorterLimit) {
  Rigid rigid(-2);
  Scheme scheme = rigid.scheme();
  const WindowReport report = scheme.advance({0, dt});
  EXPECT_NEAR(report.work.fluid, -2 * dt * 9, 1e-12);
  EXPECT_LE(report.work.gap(), 1e-12);
  EXPECT_EQ(report.force(1, 2), 5);
  EXPECT_EQ(report.log.front().force.y(), 9);
  EXPECT_EQ(report.dt_limit, 0.02);
  EXPECT_EQ(report.monitor(), (std::map<std::string, double>{{"mid.y", 3}, {"p_mid", 7}}));
  EXPECT_EQ(report.structure.at("memory.peak"), 5);
}

TEST(Scheme, GivesTheLastMotionAsItIsToAnExplicitFluidThatIsNotPredicted) {
  Rigid rigid(-2);
  SchemeParameters parameters;
  parameters.predictor = Predictor::constant;
  parameters.convergence.max_iterations = 1;
  Scheme scheme = rigid.scheme(parameters);
  for (int w = 0; w < 3; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    // The answer has moved on by 2 dt per point; its velocity by nothing.
    EXPECT_NEAR(report.residual, 2 * dt, 1e-15);
    EXPECT_NEAR(report.threshold, std::max(1e-8, 1e-4 * 2 * dt), 1e-15);
    EXPECT_NEAR(report.work.unconverged, -2 * dt * 9, 1e-12);
    scheme.commit(false);
    const Sample& told = rigid.fluid.told.back();
    EXPECT_DOUBLE_EQ(told.time, (w + 1) * dt);
    EXPECT_DOUBLE_EQ(find(told.fields, "displacement")->value(1, 0), -2 * w * dt);
    EXPECT_NEAR(find(told.fields, "velocity")->value(1, 0), -2, 1e-12);
  }
}

TEST(Scheme, GivesMotionAtTheStartOfTheWindowWithVelocityInVolumeCoupling) {
  Rigid rigid(-2, true);
  SchemeParameters parameters;
  parameters.volume = true;
  Scheme scheme(rigid.fluid, rigid.structure, identity(rigid.structure.mesh(), rigid.fluid.mesh()),
                parameters);
  for (int w = 0; w < 3; ++w) {
    EXPECT_TRUE(scheme.advance({w * dt, dt}).converged);
    scheme.commit(false);
  }
  const Sample& told = rigid.fluid.told[2];
  EXPECT_DOUBLE_EQ(told.time, 2 * dt);
  EXPECT_NEAR(find(told.fields, "displacement")->value(1, 0), -2 * 2 * dt, 1e-15);
  EXPECT_EQ(find(told.fields, "velocity")->value(1, 0), -2);
  EXPECT_EQ(rigid.fluid.calls, "ACACAC");
}

TEST(Scheme, RefusesVolumeCouplingWithoutVelocity) {
  Scripted fluid("fluid", 3), structure("structure", 3);
  SchemeParameters parameters;
  parameters.volume = true;
  EXPECT_THROW(Scheme(fluid, structure, identity(structure.mesh(), fluid.mesh()), parameters), Error);
}

/// A fluid of ten times the structure's mass: plain iteration diverges.
struct Heavy {
  models::AddedMass fluid{MatrixXd::Identity(2, 2) * 10, VectorXd::Constant(2, 1.0),
                          models::Rule::trapezoidal};
  models::Oscillators structure{MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2) * 100, VectorXd::Zero(2),
                                VectorXd::Constant(2, 1.0), models::Rule::trapezoidal};
  Scheme scheme(SchemeParameters parameters) {
    return Scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), parameters);
  }
};

TEST(Scheme, CountsAWindowThatDoesNotConvergeAsJustThat) {
  Heavy heavy;
  SchemeParameters parameters;
  parameters.convergence = {1e-9, 0, Measure::increment, 1, 3, Unconverged::accept};
  parameters.accelerator = {"constant", 1.0, 0, 0};
  Scheme scheme = heavy.scheme(parameters);
  const WindowReport report = scheme.advance({0, dt});
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_GT(report.residual, report.threshold);
  EXPECT_EQ(report.log.size(), 3u);
}

TEST(Scheme, StopsOrAsksForAShorterWindowWhereTheCaseSaysSo) {
  SchemeParameters parameters;
  parameters.convergence = {1e-9, 0, Measure::increment, 1, 3, Unconverged::stop};
  parameters.accelerator = {"constant", 1.0, 0, 0};
  Heavy heavy;
  Scheme stopping = heavy.scheme(parameters);
  EXPECT_THROW(stopping.advance({0, dt}), Error);
  Heavy again;
  parameters.convergence.then = Unconverged::halve;
  Scheme halving = again.scheme(parameters);
  const WindowReport report = halving.advance({0, dt});
  EXPECT_TRUE(report.retry);
  EXPECT_DOUBLE_EQ(report.dt_limit, dt / 2);
  EXPECT_EQ(again.structure.state().x, VectorXd::Zero(2));  // taken back
}

TEST(Scheme, TakesBothBackWhenASolverWantsAShorterWindow) {
  Rigid rigid(-2);
  const auto answer = rigid.structure.answer;
  rigid.structure.answer = [&](const Window& w, const Input& input) {
    Advanced a = answer(w, input);
    a.retry_smaller_dt = w.dt > 0.004;
    a.dt_limit = 0.004;
    a.why = "no equilibrium";
    a.fix = "less load";
    return a;
  };
  Scheme scheme = rigid.scheme();
  const WindowReport refused = scheme.advance({0, dt});
  EXPECT_TRUE(refused.retry);
  EXPECT_EQ(refused.dt_limit, 0.004);
  EXPECT_EQ(refused.why, "the structure asks for a shorter window than 0.01 s: no equilibrium");
  EXPECT_EQ(refused.fix, "less load");
  EXPECT_EQ(rigid.fluid.calls + rigid.structure.calls, "ARAR");
  EXPECT_FALSE(scheme.advance({0, refused.dt_limit}).retry);
}

TEST(Scheme, NamesTheParticipantWindowAndPointOfAValueThatIsNotFinite) {
  Rigid rigid(-2);
  const auto answer = rigid.structure.answer;
  rigid.structure.answer = [&](const Window& w, const Input& input) {
    Advanced a = answer(w, input);
    a.output.front().value.edit()(1, 2) = NAN;
    return a;
  };
  Scheme scheme = rigid.scheme();
  try {
    scheme.advance({0, dt});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::solver_fault);
    EXPECT_EQ(e.where(), "structure, window 1 (t = 0 s), iteration 1");
    EXPECT_NE(e.problem().find("displacement of interface point 2"), std::string::npos) << e.problem();
  }
}

TEST(Scheme, MovesVelocityWithTheDisplacementThroughTheAccelerator) {
  SchemeParameters parameters;
  parameters.convergence = {1e-10, 1e-16, Measure::increment, 1, 20, Unconverged::accept};
  MatrixXd end[2];
  for (const bool velocity : {false, true}) {
    models::AddedMass fluid(MatrixXd::Identity(2, 2) * 10, VectorXd::Constant(2, 1.0),
                            models::Rule::trapezoidal);
    models::Oscillators structure(MatrixXd::Identity(2, 2), MatrixXd::Identity(2, 2) * 100, VectorXd::Zero(2),
                                  VectorXd::Constant(2, 1.0), models::Rule::trapezoidal, velocity);
    Scheme scheme(fluid, structure, nearest_neighbour(structure.mesh(), fluid.mesh()), parameters);
    for (int w = 0; w < 50; ++w) {
      EXPECT_TRUE(scheme.advance({w * dt, dt}).converged);
      scheme.commit(false);
    }
    end[velocity] = scheme.state().structure.back().motion->displacement;
  }
  EXPECT_LE((end[0] - end[1]).norm(), 1e-8 * end[0].norm());
}

// A loose tolerance leaves the fluid behind the structure by the residual r of each window. Its velocity then
// differs by 2 r/dt. Computed from the fluid's own past, v' = 2(x' − x)/dt − v would add up every residual
// since the start.
TEST(Scheme, DoesNotLetTheResidualsOfWindowsAddUpInTheFluidsVelocity) {
  Heavy heavy;
  SchemeParameters parameters;
  parameters.convergence = {1e-2, 0, Measure::increment, 1, 100, Unconverged::accept};
  parameters.accelerator = {"constant", 0.05, 0, 0};
  Scheme scheme = heavy.scheme(parameters);
  double left = 0;
  for (int w = 0; w < 300; ++w) {
    const WindowReport report = scheme.advance({w * dt, dt});
    scheme.commit(false);
    const double behind = (heavy.fluid.state().v - heavy.structure.state().v).norm() / std::sqrt(2.0);
    EXPECT_NEAR(behind, 2 / dt * report.residual, 1e-10);
    left = std::max(left, report.residual);
  }
  EXPECT_GT(left, 1e-5);  // [m]: the windows did leave something
}

/// Computes the first half of so many windows twice. The second run goes on from its saved state, and both
/// must have the same windows from there on. Returns that state.
CouplingState goes_on_bit_equal(const SchemeParameters& parameters, int windows) {
  Heavy whole, half;
  Scheme one = whole.scheme(parameters), other = half.scheme(parameters);
  const auto window = [](Scheme& s, int w) {
    const WindowReport report = s.advance({w * dt, dt});
    s.commit(false);
    return report;
  };
  for (int w = 0; w < windows / 2; ++w) {
    window(one, w);
    window(other, w);
  }
  Archive archive;
  other.state().save(archive);
  CouplingState state;
  state.load(archive);
  Scheme resumed = half.scheme(parameters);
  resumed.set_state(state);
  for (int w = windows / 2; w < windows; ++w) {
    const WindowReport a = window(one, w), b = window(resumed, w);
    EXPECT_EQ(a.displacement, b.displacement) << "window " << w;
    EXPECT_EQ(a.iterations, b.iterations) << "window " << w;
    EXPECT_EQ(a.number, b.number) << "window " << w;
  }
  return state;
}

TEST(Scheme, GoesOnBitEqualFromASavedState) {
  for (const bool load_settles : {false, true}) {
    SchemeParameters parameters;
    parameters.convergence = {1e-6, 0, Measure::increment, 1, 20, Unconverged::accept};
    if (load_settles) parameters.convergence.load.relative = 1e-6;
    const CouplingState state = goes_on_bit_equal(parameters, 12);
    EXPECT_EQ(state.fluid.empty(), !load_settles);  // kept if a window uses it later
  }
}

TEST(Scheme, GoesOnBitEqualInAParallelSchemeWithAnyAccelerator) {
  for (const char* kind : {"aitken", "iqn-ils", "iqn-imvj"}) {
    SCOPED_TRACE(kind);
    SchemeParameters parameters;
    parameters.parallel = true;
    parameters.accelerator.kind = kind;
    parameters.convergence = {1e-6, 0, Measure::increment, 1, 60, Unconverged::accept};
    goes_on_bit_equal(parameters, 8);
  }
}

TEST(Scheme, WaitsForTheForceToSettleWhenMeasuredByValue) {
  Rigid rigid(-2);
  SchemeParameters parameters;
  parameters.convergence.measure = Measure::value;
  Scheme scheme = rigid.scheme(parameters);
  const WindowReport report = scheme.advance({0, dt});
  EXPECT_EQ(report.iterations, 2);  // the first has no force to compare with
  EXPECT_TRUE(report.converged);
}

}  // namespace scheme_test
}  // namespace strake
