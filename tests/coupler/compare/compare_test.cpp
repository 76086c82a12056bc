#include "coupler/compare/compare.hpp"

#include "coupler/compare/compare_block.hpp"
#include "proto/case/case_file.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace compare_test {

using Result = Verdict::Result;

std::vector<CompareBlock> blocks(const std::string& text) {
  CaseFile file = CaseFile::parse(text);
  const auto read = read_compare_blocks(file);
  file.refuse_unknown();
  return read;
}

const char* const plate = R"(
[[compare]]
probe = "mid.y"
when = { "structure.solver" = ["fem", "particle"], "structure.velocity" = "[0,-6.26,0]" }
value = { first_peak = 1.625e-3 }
tolerance = { first_peak = 0.15 }
kind = "theory"
source = "modal Galerkin"

[[compare]]
probe = "p_mid"
when = { "structure.solver" = "rigid", "fluid.sound_speed" = inf }
window = { after = "contact", from = 0.0, to = 3.0e-4 }
value = { impulse = 1294.3 }
tolerance = { impulse = 0.10 }
)";

CaseLookup lookup_in(const std::map<std::string, std::string>& values) {
  return [values](const std::string& key) -> std::optional<std::string> {
    const auto found = values.find(key);
    return found == values.end() ? std::nullopt : std::optional(found->second);
  };
}

TEST(CompareBlocks, AreReadWithConditionsWindowAndTolerances) {
  const auto read = blocks(plate);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].probe, "mid.y");
  EXPECT_EQ(read[0].when.at("structure.solver"), (std::vector<std::string>{"fem", "particle"}));
  EXPECT_EQ(read[0].metrics.front().name, "first_peak");
  EXPECT_EQ(read[0].metrics.front().tolerance, 0.15);
  EXPECT_FALSE(read[0].window);
  EXPECT_EQ(read[1].window->after, "contact");
  EXPECT_EQ(read[1].window->to, 3e-4);
  EXPECT_EQ(read[1].kind, "theory");
}

TEST(CompareBlocks, ApplyWhereEveryConditionHolds) {
  const auto read = blocks(plate);
  const auto holds = [&](std::size_t block, const std::string& solver, const std::string& speed,
                         const std::string& velocity) {
    return applies(read[block], lookup_in({{"structure.solver", solver},
                                           {"fluid.sound_speed", speed},
                                           {"structure.velocity", velocity}}));
  };
  EXPECT_TRUE(holds(0, "fem", "1500", "[0, -6.26, 0]"));
  EXPECT_TRUE(holds(0, "particle", "inf", "[0.0, -6.26]"));  // a plane vector
  EXPECT_FALSE(holds(0, "rigid", "1500", "[0, -6.26, 0]"));
  EXPECT_FALSE(holds(0, "fem", "1500", "[0, -3.13, 0]"));
  EXPECT_TRUE(holds(1, "rigid", "inf", ""));
  EXPECT_FALSE(holds(1, "rigid", "1500.0", ""));
  EXPECT_FALSE(applies(read[1], lookup_in({{"structure.solver", "rigid"}})));  // no such key
}

TEST(CompareBlocks, ComparesNumbersAsNumbers) {
  const auto read = blocks(
      "[[compare]]\nprobe = \"p\"\nwhen = { a = 1500.0, b = [1e-5, 2e-6] }\n"
      "value = { final = 1 }\ntolerance = { final = 0.1 }\n");
  EXPECT_TRUE(applies(read[0], lookup_in({{"a", "1500"}, {"b", "0.000002"}})));
  EXPECT_TRUE(applies(read[0], lookup_in({{"a", "1.5e3"}, {"b", "1e-05"}})));
  EXPECT_FALSE(applies(read[0], lookup_in({{"a", "1501"}, {"b", "1e-5"}})));
}

TEST(CompareBlocks, RefuseWhatCannotBeJudged) {
  const std::string head = "[[compare]]\nprobe = \"mid.y\"\n";
  expect_refused([&] { blocks(head + "value = { first_peek = 1 }\ntolerance = { first_peek = 1 }\n"); },
                 "first_peak");
  expect_refused([&] { blocks(head + "value = { first_peak = 1 }\n"); }, "tolerance.first_peak");
  expect_refused(
      [&] { blocks(head + "value = { first_peak = 1 }\ntolerance = { first_peak = 0.1, peak = 1 }\n"); },
      "stands in value");
  expect_refused([&] { blocks(head + "value = { peak = 1 }\ntolerance = { peak = -1 }\n"); }, "tolerance");
  expect_refused([&] { blocks(head); }, "value");
  expect_refused([&] { blocks("[[compare]]\nvalue = { peak = 1 }\ntolerance = { peak = 1 }\n"); }, "probe");
  expect_refused([&] { blocks(head + "value = { l2 = 0 }\ntolerance = { l2 = 0.1 }\n"); }, "file");
  expect_refused(
      [&] {
        blocks(head + "window = { from = 2, to = 1 }\nvalue = { mean = 0 }\ntolerance = { mean = 0.1 }\n");
      },
      "after from");
  const std::string metric = "value = { slope = 1 }\ntolerance = { slope = 0.1 }\n";
  expect_refused([&] { blocks(head + "window = { from_share = 0.9, to_share = 0.8 }\n" + metric); },
                 "from_share");
  expect_refused([&] { blocks(head + "window = { from_share = 0.8, to = 1 }\n" + metric); }, "not both");
  expect_refused([&] { blocks(head + "divide_by = 0\n" + metric); }, "not 0");
  expect_refused(
      [&] { blocks(head + "value = { mean_deviation = 0 }\ntolerance = { mean_deviation = 1 }\n"); }, "file");
  expect_refused([&] { blocks(head + "value = { peak = 1 }\ntolerance = { peak = 1 }\nsauce = \"x\"\n"); },
                 "source");
}

TEST(CompareBlocks, RefuseAReferenceThatIsNotFiniteWithItsLine) {
  TemporaryFolder folder;
  const auto read = [&](const std::string& curve) {
    put(folder / "reference.csv", curve);
    put(folder / "case.toml",
        "[[compare]]\nprobe = \"mid.y\"\nfile = \"reference.csv\"\n"
        "value = { l2 = 0 }\ntolerance = { l2 = 0.1 }\n");
    CaseFile file = CaseFile::load(folder / "case.toml");
    return read_compare_blocks(file);
  };
  const std::string head = "# digitised by hand\ntime [s],mid.y [m]\n0,0\n\n";
  EXPECT_EQ(read(head + "1,2\n").front().file.filename(), "reference.csv");
  expect_refused([&] { read(head + "1,nan\n2,0\n"); }, "reference.csv:5");
  expect_refused([&] { read(head + "1,inf\n2,0\n"); }, "reference.csv:5");
  expect_refused([&] { read(head + "1,2\n2,\n"); }, "reference.csv:6");
  expect_refused([&] { read(head + "1,2\n1,3\n"); }, "does not ascend");
  expect_refused([&] { read("T [1],Z [1]\n0,0\n1,1\n"); }, "axes = { time");
  expect_refused([&] { read("T [ms],Z [1]\n0,0\n1,1\n"); }, "not in seconds");
  expect_refused([&] { read("time [s],uy [mm]\n0,0\n1,1\n"); }, "axes = { value = 0.001 }");
  EXPECT_EQ(read("time [s],roll [deg]\n0,0\n1,1\n").size(), 1U);
}

TEST(CompareBlocks, AreExplainedWithoutAFile) {
  CaseFile file = CaseFile::declarations_only();
  EXPECT_TRUE(read_compare_blocks(file).empty());
  bool found = false;
  for (const KeyInfo& key : file.declared()) found = found || key.path == "compare[].tolerance.impulse";
  EXPECT_TRUE(found);
}

CompareBlock block_of(const std::string& probe, const std::string& metric, double value, double tolerance) {
  CompareBlock block;
  block.probe = probe;
  block.metrics = {{metric, value, tolerance}};
  return block;
}

TEST(Compare, JudgesAFirstPeakByItsMagnitudeAsSoonAsItIsKnown) {
  const CompareBlock block = block_of("mid.y", "first_peak", 1.625e-3, 0.15);
  EXPECT_EQ(judge(block, {}).front().result, Result::not_reached);
  const Verdict pass = judge(block, {{{"mid.y:first_peak", 1.6e-3}}}).front();
  EXPECT_EQ(pass.result, Result::pass);
  EXPECT_NEAR(pass.deviation(), -0.0153846, 1e-6);
  EXPECT_EQ(judge(block, {{{"mid.y:first_peak", -1.6e-3}}}).front().result, Result::pass);
  EXPECT_EQ(judge(block, {{{"mid.y:first_peak", 1.9e-3}}}).front().result, Result::fail);
  EXPECT_EQ(
      judge(block_of("mid.y", "first_peak", -1.6e-3, 0.1), {{{"mid.y:first_peak", 1.6e-3}}}).front().result,
      Result::fail);
}

TEST(Compare, TheValueThatAQuantityFallsFromIsNoFirstPeak) {
  Table history;
  history.columns = {{"time", "s"}, {"height", "m"}, {"place", "m"}};
  history.value = {{0.1, 0.2, 0.3, 0.4}, {0.9, 0.8, 0.6, 0.5}, {9, 5, 2, 1}};
  RunData data{.monitor = {{"height:first_peak", 1.0}, {"height:time_of_first_peak", 0.05}},
               .history = &history,
               .time = 0.4,
               .finished = true};
  for (const char* probe : {"height", "place"})
    EXPECT_EQ(judge(block_of(probe, "first_peak", 1, 0.1), data).front().result, Result::not_reached)
        << probe;
  data.monitor["height:contact"] = 0.01;
  EXPECT_EQ(judge(block_of("height", "first_peak", 1, 0.1), data).front().result, Result::pass)
      << "a blow in the first window";
}

TEST(Compare, WaitsForTheEndWhereALaterValueCouldChangeIt) {
  RunData data = {{{"p:peak", 2.0}, {"p:final", 1.0}}};
  EXPECT_EQ(judge(block_of("p", "peak", 2, 0.1), data).front().result, Result::not_reached);
  EXPECT_EQ(judge(block_of("p", "final", 1, 0.1), data).front().result, Result::not_reached);
  data.finished = true;
  EXPECT_EQ(judge(block_of("p", "peak", 2, 0.1), data).front().result, Result::pass);
  EXPECT_EQ(judge(block_of("p", "final", 1, 0.1), data).front().result, Result::pass);
}

TEST(Compare, TakesPeaksFromTheHistoryWhereNoSolverKeepsARecord) {
  Table history;
  history.columns = {{"window", "1"}, {"time", "s"}, {"floor.y", "m"}};
  history.value = {{1, 2, 3, 4}, {0.1, 0.2, 0.3, 0.4}, {1, 3, -1, -4}};
  RunData data{.monitor = {}, .history = &history, .time = 0.4, .finished = false};
  EXPECT_EQ(judge(block_of("floor.y", "first_peak", 3, 0.01), data).front().result, Result::not_reached);
  data.finished = true;
  EXPECT_EQ(judge(block_of("floor.y", "first_peak", 3, 0.01), data).front().result, Result::pass);
  EXPECT_EQ(judge(block_of("floor.y", "time_of_first_peak", 0.2, 0.01), data).front().result, Result::pass);
  EXPECT_EQ(judge(block_of("floor.y", "peak", -4, 0.01), data).front().result, Result::pass);
  EXPECT_EQ(judge(block_of("floor.y", "time_of_peak", 0.4, 0.01), data).front().result, Result::pass);
  // A solver that keeps a record has the last word: it counts a first peak from contact on alone.
  data.monitor["floor.y:final"] = -4;
  EXPECT_EQ(judge(block_of("floor.y", "first_peak", 3, 0.01), data).front().result, Result::not_reached);
}

TEST(Compare, TakesToleranceAsAbsoluteWhereTheReferenceIsZero) {
  const RunData data = {{{"p:impulse", 0.03}}};
  EXPECT_EQ(judge(block_of("p", "impulse", 0, 0.05), data).front().result, Result::pass);
  EXPECT_EQ(judge(block_of("p", "impulse", 0, 0.02), data).front().result, Result::fail);
}

/// A run of ten windows of 0.1 s with contact at 0.25 s: 5 Pa from then on.
Table history() {
  Table table;
  table.columns = {{"window", "1"},       {"time", "s"},   {"p", "Pa"},
                   {"p.impulse", "Pa s"}, {"p.max", "Pa"}, {"u.y", "m"}};
  table.value.resize(table.columns.size());
  for (int w = 1; w <= 10; ++w) {
    const double t = 0.1 * w;
    const double row[] = {1.0 * w,          t,     t > 0.25 ? 5.0 : 0, std::max(0.0, 5 * (t - 0.25)),
                          w == 4 ? 9.0 : 5, -2 * t};
    for (std::size_t c = 0; c < table.columns.size(); ++c) table.value[c].push_back(row[c]);
  }
  return table;
}

TEST(Compare, JudgesAWindowFromTheHistoryOnceItIsOver) {
  const Table table = history();
  RunData data = {{{"p:contact", 0.25}}, &table, 0.6, false};
  CompareBlock block = block_of("p", "impulse", 5 * 0.4, 1e-12);
  block.window = {"contact", 0.1, 0.5};
  EXPECT_EQ(judge(block, data).front().result, Result::not_reached);
  data.time = 0.8;
  EXPECT_EQ(judge(block, data).front().result, Result::pass);
  data.monitor.clear();  // no contact
  EXPECT_EQ(judge(block, data).front().result, Result::not_reached);
  data.monitor = {{"q:contact", 0.25}};  // detected by another sensor of the same body
  EXPECT_EQ(judge(block, data).front().result, Result::pass);

  CompareBlock mean = block_of("u.y", "mean", -0.9, 1e-12);
  mean.window = {"start", 0.4, 0.5};
  EXPECT_EQ(judge(mean, data).front().result, Result::pass);
  CompareBlock largest = block_of("p", "peak", 9, 1e-12);
  largest.window = {"start", 0.35, 0.45};
  EXPECT_EQ(judge(largest, data).front().result, Result::pass);
  largest.window = {"start", 0.45, 0.65};
  EXPECT_EQ(*judge(largest, data).front().value, 5);
}

// Each row has the mean force of its window: 0.1 (1 + 2 + 6) from 0.1 s on, not the 0.6 of straight lines.
TEST(Compare, ImpulseOfALoadIsThatOfItsWindows) {
  Table table;
  table.columns = {{"window", "1"}, {"time", "s"}, {"left.force.y", "N/m"}, {"u.y", "m"}};
  table.value = {{1, 2, 3, 4}, {0.1, 0.2, 0.3, 0.4}, {0, 1, 2, 6}, {0, 1, 2, 6}};
  const RunData data = {{}, &table, 0.4, true};
  const auto measured = [&](const std::string& probe, const std::string& metric) {
    CompareBlock block = block_of(probe, metric, 1, 1);
    block.window = {"start", 0.1, 0.4};
    return *judge(block, data).front().value;
  };
  EXPECT_NEAR(measured("left.force.y", "impulse"), 0.9, 1e-12);
  EXPECT_NEAR(measured("u.y", "impulse"), 0.6, 1e-12);
}

// The mean is the impulse over the time, also where a solver has shortened some windows.
TEST(Compare, MeanOfALoadIsItsImpulseOverTheTimeWhateverTheWindowsAre) {
  Table table;
  table.columns = {
      {"time", "s"}, {"force.y", "N/m"}, {"left.body.fy", "N"}, {"body.moment", "N m"}, {"u.y", "m"}};
  const std::vector<double> rows = {0, 1, 2, 6};
  table.value = {{0.1, 0.2, 0.3, 0.7}, rows, rows, rows, rows};
  const RunData data = {{}, &table, 0.7, true};
  const auto measured = [&](const std::string& probe, const std::string& metric) {
    CompareBlock block = block_of(probe, metric, 1, 1);
    block.window = {"start", 0.1, 0.7};
    return *judge(block, data).front().value;
  };
  for (const char* load : {"force.y", "left.body.fy", "body.moment"}) {
    EXPECT_NEAR(measured(load, "impulse"), 0.1 * 1 + 0.1 * 2 + 0.4 * 6, 1e-12) << load;
    EXPECT_NEAR(measured(load, "mean"), 2.7 / 0.6, 1e-12) << load;
  }
  EXPECT_NEAR(measured("u.y", "mean"), (0.05 + 0.15 + 1.6) / 0.6, 1e-12);
}

TEST(Compare, PrefersTheStepwiseImpulseOfTheProbeForItsOwnWindow) {
  const Table table = history();
  const RunData data = {{{"p:contact", 0.25}, {"p:impulse", 1290}}, &table, 0.3, false};
  CompareBlock block = block_of("p", "impulse", 1294.3, 0.1);
  block.window = {"contact", 0, 3e-4};
  EXPECT_EQ(*judge(block, data).front().value, 1290);
}

TEST(Compare, MeasuresTheDistanceToAReferenceCurve) {
  TemporaryFolder folder;
  put(folder / "reference.csv", "time [s],u.y [m]\n0.1,-0.2\n1,-2\n");
  const Table table = history();
  CompareBlock block = block_of("u.y", "l2", 0, 1e-12);
  block.file = folder / "reference.csv";
  const RunData data = {{}, &table, 1.0, true};
  EXPECT_EQ(judge(block, data).front().result, Result::pass);
  put(folder / "reference.csv", "time [s],u.y [m]\n0.1,-0.25\n1,-2.5\n");
  EXPECT_NEAR(*judge(block, data).front().value, 0.2, 1e-12);
}

/// u = −2t exactly: the reference's first point is 0.1 off, its second 0.02.
TEST(Compare, TakesTheDeviationAtThePointsOfTheReferenceInItsOwnUnits) {
  TemporaryFolder folder;
  put(folder / "reference.csv", "T [1],Z [1],raw [1]\n1,1.5,0\n4,2.9,0\n");
  const Table table = history();
  // T in units of 0.2 s, Z in −0.5 m from 0.45 m on. −0.4 m corresponds to Z = 1.7, −1.6 m to 4.1
  CompareBlock block = block_of("u.y", "largest_deviation", 0, 0.1);
  block.file = folder / "reference.csv";
  block.axes = {.time = 0.2, .time_zero = 0, .value = -0.5, .value_zero = 0.45};
  RunData data = {{}, &table, 1.0, true};
  EXPECT_NEAR(*judge(block, data).front().value, 0.6, 1e-12);
  block.metrics.front().name = "mean_deviation";
  EXPECT_NEAR(*judge(block, data).front().value, 0.5 * (0.1 + 0.6), 1e-12);
  block.column = "raw";
  EXPECT_NEAR(*judge(block, data).front().value, 0.5 * (0.85 + 2.05), 1e-12);
  block.column.clear();
  block.window = {"start", 0.1, 0.5};  // the second point is at 0.8 s
  EXPECT_NEAR(*judge(block, data).front().value, 0.1, 1e-12);
  block.window.reset();
  block.axes.time = 0.3;  // 1.2 s: the run ended before
  EXPECT_EQ(judge(block, data).front().result, Result::not_reached);
}

TEST(Compare, TakesTheSlopeOverAShareOfTheRunAndDividesIt) {
  const Table table = history();
  RunData data = {{}, &table, 1.0, false};
  CompareBlock block = block_of("u.y", "slope", -4, 1e-9);
  block.window = {"start", 0.8, 1.0, true};
  block.divide_by = 0.5;
  EXPECT_EQ(judge(block, data).front().result, Result::not_reached);  // the share is not known before the end
  data.finished = true;
  EXPECT_EQ(judge(block, data).front().result, Result::pass);
  block.metrics.front() = {"drift", -2 * 0.2 / 0.5, 1e-9};
  EXPECT_EQ(judge(block, data).front().result, Result::pass);
  block.window = {"contact", 0.5, 1.0, true};
  EXPECT_EQ(judge(block, data).front().result, Result::not_reached);
  data.monitor = {{"p:contact", 0.25}};
  block.metrics.front() = {"drift", -2 * 0.375 / 0.5, 1e-9};
  EXPECT_EQ(judge(block, data).front().result, Result::pass);
}

TEST(Compare, NoiseIsWhatIsLeftWithoutTheMean) {
  Table table;
  table.columns = {{"time", "s"}, {"p", "Pa"}};
  table.value.resize(2);
  for (int k = 0; k <= 1000; ++k) {
    table.value[0].push_back(1e-3 * k);
    table.value[1].push_back(4905 + 30 * std::sin(2 * 3.141592653589793 * k / 50));
  }
  CompareBlock block = block_of("p", "noise", 0, 49);
  block.window = {"start", 0, 1};
  const RunData data = {{}, &table, 1.0, false};
  EXPECT_NEAR(*judge(block, data).front().value, 30 / std::sqrt(2.0), 0.1);  // chords of 50 per period
}

TEST(Compare, SaysInOneLineWhatWasMeasuredExpectedAndAllowed) {
  CompareBlock block = block_of("mid.y", "first_peak", 1.625e-3, 0.15);
  block.source = "modal Galerkin";
  EXPECT_EQ(judge(block, {{{"mid.y:first_peak", 1.6e-3}}}).front().line(),
            "pass  mid.y first_peak 0.0016, expected 0.001625: -1.5 % (within 15 %), theory: modal Galerkin");
  EXPECT_EQ(
      judge(block, {{{"mid.y:first_peak", 2e-3}}}).front().line(),
      "FAIL  mid.y first_peak 0.002, expected 0.001625: +23.1 % (outside 15 %), theory: modal Galerkin");
  EXPECT_EQ(judge(block, {}).front().line(),
            "not reached  mid.y first_peak, expected 0.001625 within 15 %, theory: modal Galerkin");
  block.source.clear();  // a reference without a source is told as one
  EXPECT_EQ(judge(block, {}).front().line(),
            "not reached  mid.y first_peak, expected 0.001625 within 15 %, theory, no source named");
}

}  // namespace compare_test
}  // namespace strake
