#include "coupler/coupling/exchange.hpp"

#include "coupler/coupling/scheme.hpp"
#include "proto/error.hpp"
#include "tests/algebra/factors.hpp"
#include "tests/method/coupling/coupling_models.hpp"

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <functional>

namespace strake {
namespace exchange_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One scalar per point: answers out = M·in + c, and remembers in which order it was called.
class Linear : public models::Model<double> {
 public:
  MatrixXd matrix;
  VectorXd constant;
  std::string in, out, unit;
  std::string* calls = nullptr;

  Linear(const std::string& name, const std::string& hears, const std::string& says,
         const std::string& says_unit, MatrixXd m, VectorXd c)
      : matrix(std::move(m)), constant(std::move(c)), in(hears), out(says), unit(says_unit) {
    begin(models::line_of_points(name, constant.size()), 0);
    description_.initial = {{out, unit, false, MatrixXd::Zero(1, constant.size())}};
  }
  std::vector<Field>& announced() { return description_.initial; }
  void start(const Window& window, const Input& input) override {
    if (calls) *calls += 'S';
    Model::start(window, input);
  }
  Advanced finish() override {
    if (calls) *calls += 'F';
    return Model::finish();
  }

 private:
  Advanced step(const Window&, const Input& input) override {
    const Field* given = find(input.samples.front().fields, in);
    Advanced answer;
    answer.output = {{out, unit, false, (matrix * given->value.transpose() + constant).transpose()}};
    return answer;
  }
};

/// A tube's area and pressure, as a linear fixed point: p = F a + f, a = S p + s.
struct Tube {
  static constexpr Index n = 5;
  MatrixXd f = 2e4 * (MatrixXd::Identity(n, n) + 0.3 * MatrixXd::Ones(n, n));
  MatrixXd s = -1.2e-4 * MatrixXd::Identity(n, n);
  Linear fluid{"fluid", "area", "pressure", "Pa", f, VectorXd::LinSpaced(n, 1e4, 3e4)};
  Linear wall{"structure", "pressure", "area", "m^2", s, VectorXd::Constant(n, 1)};
  VectorXd area() const {
    return solution_of(MatrixXd::Identity(n, n) - s * f, s * fluid.constant + wall.constant);
  }
  Scheme scheme(const SchemeParameters& parameters) {
    const Mapping there = nearest_neighbour(wall.mesh(), fluid.mesh());
    return Scheme(fluid, wall, {there, nearest_neighbour(fluid.mesh(), wall.mesh())}, parameters);
  }
};

SchemeParameters tight(bool parallel) {
  SchemeParameters parameters;
  parameters.parallel = parallel;
  parameters.convergence = {1e-10, 0, Measure::value, 1, 60, Unconverged::accept};
  return parameters;
}

TEST(Exchange, CarriesAnyFieldThatTheParticipantsAnnounce) {
  Tube tube;
  Scheme scheme = tube.scheme(tight(false));
  const WindowReport report = scheme.advance({0, 0.1});
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.iterations, Tube::n + 2);
  scheme.commit(false);
  const Field& area = scheme.state().structure.back().others.at(0);
  EXPECT_EQ(area.quantity, "area");
  EXPECT_LE((area.value.transpose() - tube.area()).norm(), 1e-9 * tube.area().norm());
  const Field& pressure = scheme.state().fluid.back().fields.at(0);
  EXPECT_EQ(pressure.unit, "Pa");
  ASSERT_EQ(report.log.back().fields.size(), 2u);
  EXPECT_EQ(report.log.back().fields[1].quantity, "pressure");
  EXPECT_EQ(report.displacement.size(), 0);
  ASSERT_EQ(report.from_structure.size(), 1u);
  EXPECT_EQ(report.from_structure[0].quantity, "area");
  EXPECT_EQ(report.from_structure[0].value, area.value);
  ASSERT_EQ(report.from_fluid.size(), 1u);
  EXPECT_EQ(report.from_fluid[0].unit, "Pa");
  EXPECT_EQ(report.from_fluid[0].value, pressure.value);
}

TEST(Exchange, SharesTheFixedPointBetweenSerialAndParallelSchemes) {
  Tube tube;
  SchemeParameters parameters = tight(true);
  Scheme scheme = tube.scheme(parameters);
  std::string calls;
  tube.fluid.calls = tube.wall.calls = &calls;
  const WindowReport report = scheme.advance({0, 0.1});
  EXPECT_TRUE(report.converged) << report.iterations;
  EXPECT_EQ(calls.substr(0, 8), "SSFFSSFF");  // both begin before either is awaited
  scheme.commit(false);
  const Field& area = scheme.state().structure.back().others.at(0);
  EXPECT_LE((area.value.transpose() - tube.area()).norm(), 1e-8 * tube.area().norm());
}

TEST(Exchange, GivesEachSideTheOthersLastAnswerInAParallelExplicitScheme) {
  Tube tube;
  SchemeParameters parameters = tight(true);
  parameters.convergence.max_iterations = 1;
  parameters.predictor = Predictor::constant;
  Scheme scheme = tube.scheme(parameters);
  VectorXd area = VectorXd::Zero(Tube::n), pressure = area;
  for (int w = 0; w < 3; ++w) {
    scheme.advance({0.1 * w, 0.1});
    scheme.commit(false);
    const VectorXd next_pressure = tube.f * area + tube.fluid.constant;
    area = tube.s * pressure + tube.wall.constant;
    pressure = next_pressure;
    EXPECT_EQ(scheme.state().structure.back().others[0].value.transpose(), area);
    EXPECT_EQ(scheme.state().fluid.back().fields[0].value.transpose(), pressure);
  }
}

TEST(Exchange, AMotionAndOtherFieldsComeBackFromTheFieldsThatACheckpointHolds) {
  const Field area = {"area", "m^2", false, Eigen::RowVector2d(5, 6)};
  const StructureSample sent = {
      0.5, Motion{MatrixXd::Constant(3, 2, 1), MatrixXd::Constant(3, 2, 2)}, {area}};
  const StructureSample back = StructureSample::of({sent.time, sent.fields()});
  EXPECT_EQ(back.time, 0.5);
  ASSERT_TRUE(back.motion);
  EXPECT_EQ(back.motion->displacement, sent.motion->displacement);
  EXPECT_EQ(back.motion->velocity, sent.motion->velocity);
  ASSERT_EQ(back.others.size(), 1U);
  EXPECT_EQ(back.others[0].value, area.value);
  EXPECT_FALSE(StructureSample::of({0, {area}}).motion);
}

TEST(Exchange, GoesOnBitEqualFromASavedState) {
  for (const bool parallel : {false, true}) {
    Tube one_tube, other_tube;
    SchemeParameters parameters = tight(parallel);
    parameters.convergence.relative = 1e-3;
    Scheme one = one_tube.scheme(parameters), other = other_tube.scheme(parameters);
    const auto windows = [](Scheme& scheme, Tube& tube, int from, int to) {
      for (int w = from; w < to; ++w) {
        tube.fluid.constant.setLinSpaced(1e4, 3e4 + 1e3 * w * w);
        scheme.advance({0.1 * w, 0.1});
        scheme.commit(false);
      }
    };
    windows(one, one_tube, 0, 8);
    windows(other, other_tube, 0, 4);
    Archive archive;
    other.state().save(archive);
    CouplingState state;
    state.load(archive);
    Scheme resumed = other_tube.scheme(parameters);
    resumed.set_state(state);
    windows(resumed, other_tube, 4, 8);
    EXPECT_EQ(one.state().structure.back().others[0].value, resumed.state().structure.back().others[0].value);
    EXPECT_EQ(one.state().fluid.back().fields[0].value, resumed.state().fluid.back().fields[0].value);
    EXPECT_EQ(resumed.state().fluid.back().fields[0].unit, "Pa");
  }
}

std::string problem_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.where() + ": " + error.problem();
  }
  return "";
}

TEST(Exchange, RefusesAnswersThatDifferFromTheAnnouncement) {
  {
    Tube tube;
    tube.wall.out = "radius";
    Scheme scheme = tube.scheme(tight(false));
    EXPECT_EQ(problem_of([&] {
                scheme.advance({0, 0.1});
              }),
              "structure, window 1 (t = 0 s), iteration 1: sent no area");
  }
  {
    Tube tube;
    tube.fluid.unit = "bar";
    Scheme scheme = tube.scheme(tight(true));
    EXPECT_EQ(problem_of([&] {
                scheme.advance({0, 0.1});
              }),
              "fluid, window 1 (t = 0 s), iteration 1: sent pressure in bar, announced in Pa");
  }
}

TEST(Exchange, RefusesAnnouncementsThatItCannotMap) {
  Tube tube;
  const Mapping there = nearest_neighbour(tube.wall.mesh(), tube.fluid.mesh());
  EXPECT_NE(problem_of([&] { Scheme(tube.fluid, tube.wall, there, {}); }).find("no mapping"),
            std::string::npos);
  tube.wall.announced()[0].value = MatrixXd::Zero(1, 2);
  EXPECT_EQ(problem_of([&] { tube.scheme({}); }),
            "structure: its area at the start is 1×2 and does not fit its mesh of 5 points");
  tube.wall.announced() = {{"displacement", "m", false, MatrixXd::Zero(1, 5)}};
  EXPECT_EQ(problem_of([&] { tube.scheme({}); }),
            "structure: its displacement has 1 components, not 3 (z = 0 in 2-D)");
  tube.wall.announced() = {{"displacement", "mm", false, MatrixXd::Zero(3, 5)}};
  EXPECT_EQ(problem_of([&] { tube.scheme({}); }),
            "structure: it announces displacement in \"mm\", expected \"m\"");
  tube.wall.announced() = {{"area", "m^2", false, MatrixXd::Zero(1, 5)},
                           {"area", "m^2", false, MatrixXd::Zero(1, 5)}};
  EXPECT_EQ(problem_of([&] { tube.scheme({}); }), "structure: it announces area twice");
}

TEST(Exchange, NamesAResidualThatIsTooLargeForANumber) {
  Tube tube;
  tube.wall.matrix *= 1e160;
  Scheme scheme = tube.scheme(tight(false));
  EXPECT_NE(problem_of([&] {
              scheme.advance({0, 0.1});
            }).find("the residual of area is inf m^2"),
            std::string::npos);
}

}  // namespace exchange_test
}  // namespace strake
