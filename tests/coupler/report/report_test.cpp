#include "coupler/plot/html.hpp"
#include "coupler/plot/plot.hpp"
#include "coupler/report/sections.hpp"
#include "coupler/report/sketch.hpp"
#include "proto/files/result_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace strake::report {
namespace report_test {

using picture::figure;

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST(Html, EveryCharacterThatMeansSomethingIsEscaped) {
  EXPECT_EQ(escape("<a href=\"x\">'&'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(escape(std::string("a\0b\x07", 4)), "ab");
}

TEST(Html, QuantitiesAreReadableAndExactBesides) {
  EXPECT_EQ(quantity(0.00174235, "m"), "1.742 mm");
  EXPECT_EQ(quantity(-9.2e6, "Pa"), "−9.2 MPa");
  EXPECT_EQ(quantity(8.8e-14, "1"), "8.800e-14");
  EXPECT_EQ(quantity(std::nullopt, "m"), "–");
  EXPECT_EQ(percent(-0.0153), "−1.5 %");
  EXPECT_NE(number_cell(0.1, "m").find("data-value=\"0.1\""), std::string::npos);
}

TEST(Plot, DrawsEachCurveItsFirstPeakAndTheReference) {
  Plot plot{.title = "a < b", .x_name = "time", .x_unit = "s", .y_name = "p", .y_unit = "Pa"};
  plot.series = {
      {.name = "one", .curve = {{0, 1e-3, 2e-3}, {0, 5e6, 1e6}}, .style = 0, .marker = CurvePoint{1e-3, 6e6}},
      {.name = "two", .curve = {{0, 2e-3}, {0, 2e6}}, .style = 1}};
  plot.references = {{"theory", 4e6}};
  const std::string html = figure(plot);
  EXPECT_EQ(count(html, "<path class=\"line s"), 4U);  // two curves, two swatches
  EXPECT_EQ(count(html, "<circle class=\"ring"), 2U);
  EXPECT_EQ(count(html, "class=\"reference\""), 2U);
  EXPECT_NE(html.find("p [MPa]"), std::string::npos);
  EXPECT_NE(html.find("time [ms]"), std::string::npos);
  EXPECT_NE(html.find("a &lt; b"), std::string::npos);
}

TEST(Plot, AWindowWithoutSamplesIsNoFigureAndNoNumberIsEverNan) {
  Plot plot{.title = "t", .x_name = "time", .x_unit = "s", .y_name = "q", .y_unit = "1"};
  plot.series = {{.name = "one", .curve = {{0, 1, 2, 3}, {1, std::nan(""), 1, 1}}}};
  EXPECT_EQ(figure(plot).find("nan"), std::string::npos);
  plot.window = {7, 9};
  EXPECT_EQ(figure(plot), "");
  plot.window.reset();
  plot.logarithmic = true;
  plot.series[0].curve = {{0.01, 0.02, 0}, {1e-3, 0, 1}};
  const std::string html = figure(plot);
  EXPECT_EQ(html.find("nan"), std::string::npos);
  EXPECT_EQ(html.find("inf"), std::string::npos);
}

TEST(Plot, LogarithmicAxesCarryPowersOfTenAndLessThanADecadeRoundNumbers) {
  Plot plot{.title = "t", .x_name = "step", .x_unit = "1", .y_name = "p", .y_unit = "Pa"};
  plot.logarithmic = true;
  plot.series = {{.name = "one", .curve = {{1e-6, 1e-5, 1e-4}, {6.1e8, 6.2e7, 6.3e6}}, .dots = true}};
  const std::string wide = figure(plot);
  for (const char* tick : {">10<", ">20<", ">100<", ">500<"})
    EXPECT_NE(wide.find(tick), std::string::npos) << tick;
  plot.series[0].curve.value = {1.9e-3, 1.7e-3, 1.6e-3};
  plot.y_unit = "m";
  const std::string narrow = figure(plot);
  for (const char* tick : {">1.7<", ">1.8<", ">1.9<"})
    EXPECT_NE(narrow.find(tick), std::string::npos) << tick;
}

TEST(Plot, ManySamplesAreThinnedAndThePeakStays) {
  Plot plot{.title = "t", .x_name = "time", .x_unit = "s", .y_name = "q", .y_unit = "1"};
  Curve curve;
  for (int k = 0; k < 100'000; ++k) {
    curve.time.push_back(k);
    curve.value.push_back(k == 31'415 ? 10 : 0);
  }
  plot.series = {{.name = "one", .curve = curve}};
  const std::string html = figure(plot);
  EXPECT_LT(html.size(), 60'000U);
  plot.series[0].curve.value[31'415] = 0;
  EXPECT_NE(figure(plot), html);
}

TEST(Plot, ASampleWithoutOneBesideItIsADot) {
  Plot plot{.title = "t", .x_name = "time", .x_unit = "s", .y_name = "q", .y_unit = "1"};
  const double none = std::nan("");
  plot.series = {{.name = "static", .curve = {{1}, {2}}}};
  EXPECT_EQ(count(figure(plot), "<circle class=\"dot s0\""), 1U) << "a history of one row";
  plot.series[0].curve = {{1, 2, 3, 4, 5}, {1, 2, none, 3, none}};
  EXPECT_EQ(count(figure(plot), "<circle class=\"dot s0\""), 1U) << "the 4th, between two that are not known";
  plot.series[0].curve = {{1, 2}, {1, 2}};
  EXPECT_EQ(count(figure(plot), "<circle class=\"dot s0\""), 0U);
}

TEST(Chart, DrawsEveryPlotWithNamesUnitsReferencesAndLegend) {
  Plot plot{.title = "mid.y", .x_name = "time", .x_unit = "s", .y_name = "mid.y", .y_unit = "m"};
  plot.series = {
      {.name = "one", .curve = {{0, 1e-3, 2e-3}, {0, 2e-3, 1e-3}}, .marker = CurvePoint{1e-3, 2e-3}},
      {.name = "two", .curve = {{1e-3}, {1e-3}}, .style = 1, .dots = true}};
  plot.references = {{.name = "first peak, theory", .value = 1.6e-3, .within = 1e-4}};
  Plot empty = plot;
  empty.window = {7, 9};
  const picture::ChartOptions options = {.width = 600, .height_of_plot = 300};
  const std::string png = picture::chart({plot, empty, plot}, options, picture::Canvas::Kind::png);
  ASSERT_TRUE(png.starts_with("\x89PNG"));
  const auto size_at = [&](std::size_t at) {
    int value = 0;
    for (std::size_t k = at; k < at + 4; ++k) value = 256 * value + static_cast<unsigned char>(png[k]);
    return value;
  };
  EXPECT_EQ(size_at(16), 600);
  EXPECT_EQ(size_at(20), 600) << "two plots, the empty one is left out";
  EXPECT_EQ(picture::chart({empty}, options, picture::Canvas::Kind::png), "");
  const std::string svg = picture::chart({plot}, options, picture::Canvas::Kind::svg);
  EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos) << "the reference";
  plot.references.clear();
  EXPECT_NE(picture::chart({plot}, options, picture::Canvas::Kind::svg), svg);
}

/// A run with the history of one column, a row a second, and its first peak.
Recorded run_with(const std::string& column, const std::vector<double>& values,
                  const CurvePoint& first_peak) {
  Recorded run;
  run.name = "run";
  run.end_time = static_cast<double>(values.size());
  run.history.columns = {{"time", "s"}, {column, "m"}};
  run.history.value = {{}, values};
  for (std::size_t i = 0; i < values.size(); ++i) run.history.value[0].push_back(static_cast<double>(i + 1));
  run.probes = {{column, "m", {{"first_peak", first_peak.value}, {"time_of_first_peak", first_peak.time}}}};
  return run;
}

TEST(Metrics, WhatStaysAtZeroOrAtRoundOffIsFoldedAway) {
  Recorded run;
  run.name = "run";
  for (const auto& [column, peak] :
       std::initializer_list<std::pair<const char*, double>>{{"body.fy", 2e6},
                                                             {"body.fx", 0.01},
                                                             {"body.moment", 5e-4},
                                                             {"body.angle", 0},
                                                             {"body.rate", 1e-9}})
    run.probes.push_back({column, "1", {{"peak", peak}}});
  const std::string html = metrics({run});
  const auto fold = html.find("<details>");
  ASSERT_NE(fold, std::string::npos);
  for (const char* shown : {"body.fy", "body.rate"}) EXPECT_LT(html.find(shown), fold) << shown;
  for (const char* folded : {"body.fx", "body.moment", "body.angle"})
    EXPECT_GT(html.find(folded), fold) << folded;
}

/// A run folder with a case of compare blocks and a summary.
Recorded run_of(const TemporaryFolder& folder, const std::string& blocks, const std::string& summary) {
  const auto put = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path() / name) << text;
  };
  put("run.json", R"({"contact": {"p": 0.1}})");
  put("case.toml", "title = \"t\"\n" + blocks);
  put("summary.json", summary);
  put("history.csv", "time [s],p [Pa],p.impulse [Pa s]\n0.1,0,0\n0.2,10,1\n0.3,20,3\n");
  return read_run(folder.path());
}

TEST(Failures, OfSeveralBodiesAreToldBodyByBody) {
  TemporaryFolder one, none;
  const std::string html = failures({run_of(one, "", R"({"failure": {"left": {"start": {"time": 1e-3,
      "x": 0.2, "y": 0, "z": 0}, "crack": null, "parted": null, "energy": 3.5}, "right": null}})")});
  for (const char* words : {"left: strength reached", "left: energy released", "200 mm", "3.5 J"})
    EXPECT_NE(html.find(words), std::string::npos) << words << "\n" << html;
  EXPECT_EQ(html.find("right"), std::string::npos) << "nothing can break it";
  EXPECT_EQ(failures({run_of(none, "", R"({"failure": {"left": null, "right": null}})")}), "");
}

// A block with a window, or with a divisor, measures something else than the probe's own record.
TEST(Metrics, AReferenceStandsBesideWhatItsBlockMeasured) {
  TemporaryFolder folder;
  const Recorded run = run_of(folder, R"(
[[compare]]
probe = "p"
value = { impulse = 2.0, peak = 4.0 }
tolerance = { impulse = 0.5, peak = 0.5 }
window = { from = 0.1, to = 0.3 }
divide_by = 5.0
source = "s"
)",
                              R"({"probes": {"p": {"unit": "Pa", "impulse": 7.5, "peak": 20}}, "compare": [
{"probe": "p", "metric": "impulse", "value": 0.6, "reference": 2, "tolerance": 0.5, "pass": false,
 "kind": "theory", "source": "s"},
{"probe": "p", "metric": "peak", "value": 4, "reference": 4, "tolerance": 0.5, "pass": true,
 "kind": "theory", "source": "s"}]})");
  const std::string html = metrics({run});
  for (const char* own : {"7.5 Pa s", "20 Pa", ">0.6<", ">4<", "in its window over 5:"})
    EXPECT_NE(html.find(own), std::string::npos) << own << "\n" << html;
  for (const char* of_another : {"600 mPa s", "4 Pa<", "2 Pa s"})
    EXPECT_EQ(html.find(of_another), std::string::npos) << of_another << "\n" << html;
  EXPECT_EQ(history_figures({run}, "").find("300 µs"), std::string::npos) << "the block has its own window";
}

TEST(StudyChecks, AReferenceOfZeroHasDeviationsInItsUnitAndWhatIsMissingIsNotOutside) {
  StudyData study;
  study.columns = {{"front", "largest_deviation", "m"}};
  study::CheckResult check;
  check.probe = "front";
  check.metric = "largest_deviation";
  check.reference = 0;
  check.value = check.deviation = 0.02;
  check.tolerance = 0.03;
  check.pass = true;
  study.checks = {check};
  check.value = check.deviation = {};
  check.pass = false;
  study.checks.push_back(check);
  const std::string html = study_checks(study);
  EXPECT_EQ(html.find('%'), std::string::npos) << html;
  EXPECT_EQ(count(html, "20 mm"), 2U) << "value and deviation";
  EXPECT_EQ(count(html, "30 mm"), 2U);
  EXPECT_EQ(html.find("outside"), std::string::npos);
  EXPECT_NE(html.find("not measured"), std::string::npos);
  EXPECT_EQ(count(html, "no source is stated"), 2U);
}

TEST(Histories, WhatFallsFromItsStartOrAtContactHasNoFirstPeak) {
  std::vector<double> falling(100);
  for (std::size_t i = 0; i < falling.size(); ++i) falling[i] = 100 - static_cast<double>(i);
  const auto zooms = [&](const CurvePoint& first_peak) {
    const std::string html = history_figures({run_with("height", falling, first_peak)}, "");
    return count(html, "around the first peak");
  };
  EXPECT_EQ(zooms({0.5, 100}), 0U) << "in the first window";
  EXPECT_EQ(zooms({20, 81}), 0U) << "its value at contact";
  EXPECT_GT(zooms({20, 83}), 0U) << "higher than the row before";
  Recorded blow = run_with("force.y", falling, {0.5, 100});
  blow.windows = 100;
  EXPECT_EQ(count(history_figures({blow}, ""), "around the first peak"), 0U);
  blow.contact["body"] = 0;
  EXPECT_GT(count(history_figures({blow}, ""), "around the first peak"), 0U)
      << "a force that begins with contact";
}

TEST(Histories, ComponentsAtRoundOffAreNotDrawn) {
  Recorded run = run_with("body.fy", {1e6, 2e6}, {2, 2e6});
  for (const auto& [column, size] : std::initializer_list<std::pair<const char*, double>>{
           {"body.fx", 0.01}, {"body.moment", 0.01}, {"body.vy", 0.01}, {"body.rate", 0}}) {
    run.history.columns.push_back({column, "1"});
    run.history.value.push_back({size, size});
    run.probes.push_back({column, "1", {{"peak", size}}});
  }
  const std::string html = history_figures({run}, "");
  for (const char* drawn : {"body.fy", "body.vy"}) EXPECT_GT(count(html, drawn), 0U) << drawn;
  for (const char* not_drawn : {"body.fx", "body.moment", "body.rate"})
    EXPECT_EQ(count(html, not_drawn), 0U) << not_drawn;
}

TEST(Histories, AReferenceWithAWindowIsDrawnOverItAlone) {
  Recorded run = run_with("force.y", {1, 2, 3, 4}, {4, 4});
  study::CheckResult verdict;
  verdict.probe = "force.y";
  verdict.metric = "mean";
  verdict.kind = "theory";
  verdict.reference = 3.5;
  run.compare = {verdict};
  CompareBlock block;
  block.probe = "force.y";
  block.metrics = {{"mean", 3.5, 0.1}};
  run.blocks = {block};
  const std::string whole = history_figures({run}, "");
  run.blocks.front().window = {"start", 2, 4};
  const std::string part = history_figures({run}, "");
  EXPECT_NE(part, whole);
  run.blocks.front().window = {"start", 0.5, 1, true};
  EXPECT_EQ(history_figures({run}, ""), part) << "the last half of four seconds";
  run.contact["body"] = 1;
  run.blocks.front().window = {"contact", 1, 3};
  EXPECT_EQ(history_figures({run}, ""), part);
}

TEST(Histories, AReferenceCurveIsDrawnOnceBesideTheRuns) {
  Recorded run = run_with("front", {1, 2, 3}, {3, 3});
  run.reference_curves = {{"front", "measured, experiment", {{1, 2}, {1.1, 2.2}}}};
  const std::string html = history_figures({run, run}, "");
  EXPECT_EQ(count(html, "measured, experiment"), count(history_figures({run}, ""), "measured, experiment"));
  EXPECT_GT(count(html, "measured, experiment"), 0U);
  run.reference_curves.front().probe = "height";
  EXPECT_EQ(count(history_figures({run}, ""), "measured, experiment"), 0U);
}

TEST(Outline, OfTwoSquaresSideBySideIsOneRectangle) {
  picture::Scene scene;
  scene.cells = {{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0}, {{{1, 1}, {2, 1}, {2, 0}, {1, 0}}, 0}};
  const auto loops = outline(scene);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].size(), 4U);
}

TEST(Outline, OfParticlesAroundAHoleIsTwoLoops) {
  picture::Scene scene;
  scene.solid_spacing = 1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i != 1 || j != 1) scene.solid.push_back({{static_cast<double>(i), static_cast<double>(j)}, 0});
  EXPECT_EQ(outline(scene).size(), 2U);
}

TEST(Outline, OfFacetsInAnyOrderIsOneWalk) {
  const std::vector<picture::Place> corner = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  picture::Scene scene;
  // One after the other: GCC 12.2 at -O3 gets the last number of nested lists of these wrong.
  for (const auto& [a, b] :
       std::vector<std::pair<std::size_t, std::size_t>>{{2, 3}, {0, 1}, {3, 0}, {2, 1}}) {
    scene.cells.emplace_back();
    scene.cells.back().corner = {corner[a], corner[b]};
  }
  const auto loops = outline(scene);
  ASSERT_EQ(loops.size(), 1U);
  ASSERT_EQ(loops[0].size(), 5U);  // back at its start
  for (std::size_t i = 1; i < loops[0].size(); ++i) {
    const picture::Place &from = loops[0][i - 1], &to = loops[0][i];
    EXPECT_EQ(std::hypot(to.x - from.x, to.y - from.y), 1)
        << from.x << " " << from.y << " to " << to.x << " " << to.y;
  }
}

TEST(Limits, AirIsJudgedByThePressureOfTheOpenAirOfItsCase) {
  Recorded run;
  run.solver["fluid"] = "own";
  run.history.columns = {{"time", "s"}, {"air.left", "m"}, {"air.largest_pressure", "Pa"}};
  run.history.value = {{0, 1}, {0.01, 0.005}, {0, 50e3}};
  EXPECT_NE(limits({run}).find("compressed a little"), std::string::npos);
  run.settings = {{"fluid.air.pressure", "10000", "Pa", "case"}};
  EXPECT_NE(limits({run}).find("shaped the peak"), std::string::npos);
  run.settings = {{"fluid.air.pressure", "1e6", "Pa", "case"}};
  EXPECT_NE(limits({run}).find("hardly mattered"), std::string::npos);
}

TEST(Sketch, ARigidBodyHasNoSupports) {
  Recorded run;
  const auto set = [&](const char* key, const char* value) {
    run.settings.push_back({key, value, "", "case"});
  };
  set("fluid.tank", "[[-1, -1], [1, 1]]");
  set("structure.plate.length", "0.4");
  set("structure.plate.thickness", "0.02");
  set("structure.plate.bottom", "[0, 0, 0]");
  set("structure.plate.supports.left", "clamped");
  set("structure.solver", "fem");
  picture::Scene scene;
  scene.cells = {{{{-0.2, 0}, {0.2, 0}, {0.2, 0.02}, {-0.2, 0.02}}, 0}};
  EXPECT_NE(sketch(run, &scene).find("supports: left clamped"), std::string::npos);
  run.settings.back().value = "rigid";
  EXPECT_EQ(sketch(run, &scene).find("clamped"), std::string::npos);
}

TEST(Sketch, ReadsPointsOfTwoAndOfThreeNumbers) {
  const auto three = places("[[-1, -0.5, 0], [1, 1e-1, 0]]");
  ASSERT_EQ(three.size(), 2U);
  EXPECT_EQ(three[1].y, 0.1);
  EXPECT_EQ(places("[[0, 0], [1, 0], [1, 2]]").size(), 3U);
  EXPECT_TRUE(places("none").empty());
}

}  // namespace report_test
}  // namespace strake::report
