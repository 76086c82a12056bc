#include "coupler/window_message.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "coupler/case_scheme.hpp"
#include "proto/error.hpp"

namespace strake {
namespace {

const std::vector<Column> measured = {{"displacement", "m"}, {"force", "N"}};

WindowMessage window_of_two_iterations() {
  WindowMessage m;
  m.window.number = 421;
  m.window.time = 0.1 + 0.2;
  m.window.output = true;
  m.window.taken_back = 2;
  m.window.why = "a window of 1e-05 s does not converge in 3 iterations";
  m.window.begin = 68'123'456'789'012;
  m.window.end = m.window.begin + 1;
  WindowReport& report = m.window.report;
  report.window = {0.1, 0.2};
  report.number = 421;
  report.iterations = 2;
  report.residual = 1.0 / 3;
  report.threshold = 1e-9;
  report.converged = true;
  report.work_fluid = -0.7;
  report.work_structure = -0.7000001;
  report.work_unconverged = 1e-17;
  report.displacement = Points::Random(3, 4);
  report.force = Points::Random(3, 4);
  report.from_structure = {{"temperature", "K", false, Eigen::RowVector4d(1, 2, 3, 4)}};
  report.from_fluid = {{"pressure", "Pa", false, Eigen::RowVector4d(5, 6, 7, 8)},
                       {"heat", "W", true, Eigen::RowVector4d(9, 8, 7, 6)}};
  report.fluid = {{"p_mid", 3.25}, {"seconds.pressure", 0.5}};
  report.structure = {{"p_mid", -1}, {"mid:peak", std::nan("")}};
  for (int i = 1; i <= 2; ++i) {
    IterationReport row;
    row.iteration = i;
    row.residual = 0.1 / i;
    row.threshold = 1e-9;
    row.relaxation = 0.5;
    row.columns = 7;
    row.dropped = 1;
    row.force = {1, 2, 0.1 * i};
    row.fields = {{"displacement", "m", 0.1 / i, 1e-9}, {"force", "N", 3.0 / i, 1e-3}};
    report.log.push_back(row);
  }
  m.state = {.time = 0.30000000000000004, .windows = 421, .length = 5e-6, .settled = 3};
  m.exchanges = {{"fluid", "Advance", 421, 1, 10, 40, 20, 30},
                 {"structure", "Advance", 421, 2, 50, 80, 60, 70}};
  return m;
}

TEST(WindowMessage, KeepsAllThatTheFilesAndTheConsoleAreMadeOf) {
  const WindowMessage sent = window_of_two_iterations();
  const WindowMessage got = from_message(to_message(sent), measured);
  EXPECT_EQ(got.window.number, 421);
  EXPECT_EQ(got.window.time, sent.window.time);
  EXPECT_TRUE(got.window.output);
  EXPECT_FALSE(got.window.last);
  EXPECT_EQ(got.window.taken_back, 2);
  EXPECT_EQ(got.window.why, sent.window.why);
  EXPECT_EQ(got.window.begin, sent.window.begin);
  EXPECT_EQ(got.window.end, sent.window.end);
  const WindowReport &a = sent.window.report, &b = got.window.report;
  EXPECT_EQ(b.window.t, a.window.t);
  EXPECT_EQ(b.window.dt, a.window.dt);
  EXPECT_EQ(b.number, 421);
  EXPECT_EQ(b.iterations, 2);
  EXPECT_EQ(b.residual, a.residual);
  EXPECT_EQ(b.threshold, a.threshold);
  EXPECT_TRUE(b.converged);
  EXPECT_EQ(b.dt_limit, a.dt_limit);
  EXPECT_EQ(b.work_fluid, a.work_fluid);
  EXPECT_EQ(b.work_structure, a.work_structure);
  EXPECT_EQ(b.work_unconverged, a.work_unconverged);
  EXPECT_EQ(b.displacement, a.displacement);
  EXPECT_EQ(b.velocity.cols(), 0) << "the structure sends none";
  EXPECT_EQ(b.force, a.force);
  for (const auto& fields : {&WindowReport::from_structure, &WindowReport::from_fluid}) {
    ASSERT_EQ((b.*fields).size(), (a.*fields).size());
    for (std::size_t k = 0; k < (a.*fields).size(); ++k) {
      EXPECT_EQ((b.*fields)[k].quantity, (a.*fields)[k].quantity);
      EXPECT_EQ((b.*fields)[k].unit, (a.*fields)[k].unit);
      EXPECT_EQ((b.*fields)[k].conservative, (a.*fields)[k].conservative);
      EXPECT_EQ((b.*fields)[k].value, (a.*fields)[k].value);
    }
  }
  EXPECT_EQ(b.fluid, a.fluid);
  EXPECT_EQ(b.structure.at("p_mid"), -1) << "of two with one name each keeps its side";
  EXPECT_TRUE(std::isnan(b.structure.at("mid:peak")));
  ASSERT_EQ(b.log.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(b.log[i].iteration, a.log[i].iteration);
    EXPECT_EQ(b.log[i].residual, a.log[i].residual);
    EXPECT_EQ(b.log[i].threshold, a.log[i].threshold);
    EXPECT_EQ(b.log[i].relaxation, a.log[i].relaxation);
    EXPECT_EQ(b.log[i].columns, 7);
    EXPECT_EQ(b.log[i].dropped, 1);
    EXPECT_EQ(b.log[i].force, a.log[i].force);
    ASSERT_EQ(b.log[i].fields.size(), 2u);
    EXPECT_EQ(b.log[i].fields[1].quantity, "force");
    EXPECT_EQ(b.log[i].fields[1].unit, "N");
    EXPECT_EQ(b.log[i].fields[1].residual, a.log[i].fields[1].residual);
    EXPECT_EQ(b.log[i].fields[1].threshold, a.log[i].fields[1].threshold);
  }
  EXPECT_EQ(got.state.time, sent.state.time);
  EXPECT_EQ(got.state.windows, 421);
  EXPECT_EQ(got.state.length, 5e-6);
  EXPECT_EQ(got.state.settled, 3);
  EXPECT_TRUE(std::isinf(got.state.limit));
  ASSERT_EQ(got.exchanges.size(), 2u);
  EXPECT_EQ(got.exchanges[0].participant, "fluid");
  EXPECT_EQ(got.exchanges[1].participant, "structure");
  EXPECT_EQ(got.exchanges[1].iteration, 2u);
  EXPECT_EQ(got.exchanges[1].sent, 50);
  EXPECT_EQ(got.exchanges[1].heard, 80);
  EXPECT_EQ(got.exchanges[1].received, 60);
  EXPECT_EQ(got.exchanges[1].answered, 70);
}

TEST(WindowMessage, OfVolumeCouplingMeasuresNothing) {
  WindowMessage sent = window_of_two_iterations();
  for (IterationReport& row : sent.window.report.log) row.fields.clear();
  EXPECT_TRUE(from_message(to_message(sent), measured).window.report.log.at(1).fields.empty());
}

TEST(WindowMessage, ThatIsIncompleteIsRefused) {
  Advanced whole = to_message(window_of_two_iterations());
  for (const std::string name : {"number", "loop.length", "work.fluid"}) {
    Advanced cut = whole;
    cut.monitor.erase(name);
    EXPECT_THROW(from_message(cut, measured), Error) << name;
  }
  Advanced short_of_one = whole;
  short_of_one.history.pop_back();
  EXPECT_THROW(from_message(short_of_one, measured), Error);
  for (std::size_t k = 0; k < whole.output.size(); ++k) {
    Advanced cut = whole;
    cut.output.erase(cut.output.begin() + static_cast<std::ptrdiff_t>(k));
    EXPECT_THROW(from_message(cut, measured), Error) << whole.output[k].quantity;
    Advanced thin = whole;
    thin.output[k].value = Eigen::MatrixXd::Zero(1, 2);
    EXPECT_THROW(from_message(thin, measured), Error) << whole.output[k].quantity;
  }
}

TEST(CaseScheme, KnowsWhatElseMayHelpWhereNoWindowIsShortEnough) {
  CouplingCase view;
  view.coupling.max_iterations = 20;
  EXPECT_EQ(remedy_of(view), "");
  view.coupling.max_iterations = 1;
  EXPECT_NE(remedy_of(view).find("raise coupling.surface.converged.max_iterations"), std::string::npos);
  view.common.fluid_solver = "replay";
  EXPECT_NE(remedy_of(view).find("the load is recorded"), std::string::npos);
}

}  // namespace
}  // namespace strake
