#include "coupler/summary/summary.hpp"

#include "coupler/summary/history_metrics.hpp"
#include "coupler/summary/notes.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

namespace strake {
namespace summary_test {

std::set<std::string> keys(const nlohmann::ordered_json& json) {
  std::set<std::string> names;
  for (const auto& [name, value] : json.items()) names.insert(name);
  return names;
}

CommittedWindow window_with(int iterations, bool converged, double work_fluid, double work_structure) {
  CommittedWindow window;
  window.time = 0.5;
  window.report.iterations = iterations;
  window.report.converged = converged;
  window.report.work.fluid = work_fluid;
  window.report.work.structure = work_structure;
  window.report.fluid = {{"count.fluid", 10000},    {"count.steps", 12},           {"seconds.pressure", 1.5},
                         {"p_mid:impulse", 1294.3}, {"check.momentum_gap", 1e-13}, {"memory.peak", 1e8}};
  window.report.structure = {
      {"mid.y", -1e-3}, {"mid.y:final", -1e-3}, {"check.structure_energy_drift", std::nan("")}};
  return window;
}

TEST(Summary, TheContactOfABodyWithoutProbesCountsAndIsNoProbe) {
  Table history;
  history.columns = {{"window", "1"}, {"time", "s"}, {"force.y", "N/m"}};
  history.value.resize(3);
  for (int k = 1; k <= 20; ++k) {
    history.value[0].push_back(k);
    history.value[1].push_back(1e-4 * k);
    history.value[2].push_back(k <= 10 ? 0 : 500);
  }
  const auto impulse_after = [&](std::map<std::string, double> fluid) {
    CommittedWindow window = window_with(1, true, 0, 0);
    window.report.fluid = std::move(fluid);
    Summary summary("case", "");
    summary.add(window);
    summary.take_history(history);
    const auto json = summary.json();
    EXPECT_FALSE(json["probes"].contains("body"));
    return json["probes"]["force.y"]["impulse"];
  };
  EXPECT_NEAR(impulse_after({{"body:contact", 1.1e-3}}).get<double>(), 500 * 3e-4, 1e-9);
  EXPECT_TRUE(impulse_after({{"count.awaiting_contact", 1}}).is_null());
}

TEST(Summary, ContactInTheFirstStepIsTheEarliestOfAll) {
  CommittedWindow window = window_with(1, true, 0, 0);
  window.report.fluid = {{"p_first:contact", 0}, {"p_second:contact", 0.2}};
  window.report.structure["mid.y:first_peak"] = -1e-3;
  window.report.structure["mid.y:time_of_first_peak"] = 0.1;
  Summary summary("case", "");
  summary.add(window);
  EXPECT_EQ(summary.json()["probes"]["mid.y"]["first_peak"], -1e-3);
}

TEST(Summary, AGaugeKeepsItsFirstPeakWhileABodyIsInTheAir) {
  CommittedWindow window = window_with(1, true, 0, 0);
  window.report.fluid = {
      {"count.awaiting_contact", 1}, {"gauge:first_peak", 0.2}, {"gauge:time_of_first_peak", 0.1}};
  Summary summary("case", "");
  summary.add(window);
  EXPECT_EQ(summary.json()["probes"]["gauge"]["first_peak"], 0.2);
}

TEST(Summary, WhatFallsFromItsStartHasNoFirstPeak) {
  Table history;
  history.columns = {{"time", "s"}, {"height", "m"}, {"p_mid", "Pa"}, {"force.y", "N/m"}, {"body.vy", "m/s"}};
  history.value = {{1, 2, 3, 4}, {0.9, 0.8, 0.5, 0.4}, {90, 80, 50, 40}, {9, 8, 5, 4}, {9, 8, 5, 4}};
  CommittedWindow window = window_with(1, true, 0, 0);
  window.report.structure.clear();
  window.report.fluid = {{"height:first_peak", 1.0},
                         {"height:time_of_first_peak", 0.1},
                         {"p_mid:first_peak", 100},
                         {"p_mid:time_of_first_peak", 0.1}};
  const auto probes_of = [&] {
    Summary summary("case", "");
    summary.add(window);
    summary.take_history(history);
    return summary.json()["probes"];
  };
  const auto dry = probes_of();
  EXPECT_EQ(dry.size(), 4U);
  for (const auto& [name, entry] : dry.items()) {
    EXPECT_TRUE(entry["first_peak"].is_null()) << name;
    EXPECT_TRUE(entry["time_of_first_peak"].is_null()) << name;
  }
  window.report.fluid["p_mid:contact"] = 0;
  const auto probes = probes_of();
  EXPECT_EQ(probes["p_mid"]["first_peak"], 100) << "a blow in the first window";
  EXPECT_EQ(probes["force.y"]["first_peak"], 9) << "the force of that blow";
  for (const char* name : {"height", "body.vy"}) EXPECT_TRUE(probes[name]["first_peak"].is_null()) << name;
}

TEST(Summary, HoldsExactlyTheKeysThatScriptsRelyOn) {
  const auto json = Summary("plate_entry", "rigid").json();
  EXPECT_EQ(keys(json), (std::set<std::string>{"case", "tag", "exit_code", "end_time", "windows",
                                               "iterations", "particles", "steps", "steps_committed",
                                               "seconds", "ranks", "peak_memory_bytes", "probes", "checks",
                                               "alarms", "resolution", "failure", "compare"}));
  EXPECT_EQ(keys(json["iterations"]), (std::set<std::string>{"mean", "max", "unconverged", "taken_back"}));
  EXPECT_EQ(keys(json["particles"]), (std::set<std::string>{"fluid", "wall", "solid"}));
  EXPECT_EQ(keys(json["seconds"]), (std::set<std::string>{"wall", "fluid", "structure", "coupler"}));
  EXPECT_EQ(keys(json["peak_memory_bytes"]), (std::set<std::string>{"fluid", "structure", "coupler"}));
  EXPECT_EQ(keys(json["checks"]),
            (std::set<std::string>{"work_gap", "momentum_gap", "structure_energy_drift", "inner_fraction_min",
                                   "voids", "openings", "penetrations", "lost", "volume_drift",
                                   "largest_speed", "largest_pressure", "grades"}));
}

TEST(Summary, CollectsWhatTheParticipantsReport) {
  Summary summary("plate_entry", "");
  summary.describe({{"mid.y", "m"}, {"p_mid", "Pa"}});
  summary.add(window_with(3, true, 1.0, 1.0));
  summary.add(window_with(6, false, 1.0, 0.75));
  const auto json = summary.json();
  EXPECT_EQ(json["windows"], 2);
  EXPECT_EQ(json["iterations"]["mean"], 4.5);
  EXPECT_EQ(json["iterations"]["max"], 6);
  EXPECT_EQ(json["iterations"]["unconverged"], 1);
  EXPECT_EQ(json["particles"]["fluid"], 10000);
  EXPECT_EQ(json["seconds"]["fluid"]["pressure"], 1.5);
  EXPECT_EQ(json["probes"]["p_mid"]["impulse"], 1294.3);
  EXPECT_EQ(json["probes"]["p_mid"]["unit"], "Pa");
  EXPECT_EQ(json["probes"]["mid.y"]["final"], -1e-3);
  EXPECT_TRUE(json["probes"]["mid.y"]["first_peak"].is_null());
  EXPECT_EQ(json["checks"]["work_gap"], 0.25);
  EXPECT_EQ(json["checks"]["momentum_gap"], 1e-13);
}

TEST(Summary, TellsWhereAndWhenABodyFailsAndTheConsoleHearsItOnce) {
  Summary summary("plate_failure", "");
  CommittedWindow window = window_with(1, true, 0, 0);
  summary.add(window);
  EXPECT_TRUE(summary.json()["failure"].is_null()) << "nothing was asked to fail";
  auto& monitor = window.report.structure;
  monitor["failure.energy"] = 0;
  FailureNotes surface(true, 0), volume(false, 0), resumed(true, 1e-3);
  EXPECT_TRUE(surface.look(monitor).empty());
  for (const std::string event : {"start", "parted"}) {
    monitor["failure." + event + ".time"] = 1e-3;
    for (const char* axis : {"x", "y", "z"}) monitor["failure." + event + "." + axis] = 0.2;
  }
  summary.add(window);
  const auto json = summary.json()["failure"];
  EXPECT_EQ(json["start"]["time"], 1e-3);
  EXPECT_EQ(json["parted"]["x"], 0.2);
  EXPECT_TRUE(json["crack"].is_null());
  EXPECT_EQ(json["energy"], 0);
  const std::vector<std::string> lines = surface.look(monitor);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_NE(lines[0].find("t = 0.001 s at (0.2, 0.2, 0.2) m"), std::string::npos) << lines[0];
  EXPECT_NE(lines[2].find("stay dry"), std::string::npos) << lines[2];
  EXPECT_TRUE(surface.look(monitor).empty());
  EXPECT_EQ(volume.look(monitor).size(), 2U);
  EXPECT_TRUE(resumed.look(monitor).empty());
}

// The force along x of a symmetric body had a first peak of 0.6 mN beside 35 kN.
TEST(Summary, RoundOffAndZerosHaveNoFirstPeakAndNoTime) {
  Table history;
  history.columns = {
      {"time", "s"}, {"force.x", "N/m"}, {"force.y", "N/m"}, {"moment.z", "N"}, {"body.vx", "m/s"}};
  history.value = {
      {1, 2, 3, 4}, {1e-4, 9e-4, 1e-4, 0}, {1e3, 3e4, 2e3, 1e3}, {1e-5, 2e-5, 0, 0}, {0, 0, 0, 0}};
  Summary summary("wedge", "");
  summary.add(window_with(1, true, 0, 0));
  summary.take_history(history);
  const auto probes = summary.json()["probes"];
  EXPECT_EQ(probes["force.y"]["first_peak"], 3e4);
  EXPECT_TRUE(probes["force.x"]["first_peak"].is_null());
  EXPECT_TRUE(probes["force.x"]["time_of_first_peak"].is_null());
  EXPECT_EQ(probes["force.x"]["peak"], 9e-4);
  EXPECT_TRUE(probes["moment.z"]["first_peak"].is_null());
  EXPECT_EQ(probes["body.vx"]["peak"], 0);
  EXPECT_TRUE(probes["body.vx"]["time_of_peak"].is_null());
}

TEST(Summary, TellsTheRanksOfEachOfSeveralBodies) {
  CommittedWindow window = window_with(1, true, 0, 0);
  window.report.structure["left.ranks.0.busy"] = 2;
  window.report.structure["left.ranks.1.busy"] = 3;
  Summary summary("case", "");
  summary.bodies = {"left", "right"};
  summary.add(window);
  const auto ranks = summary.json()["ranks"];
  ASSERT_EQ(ranks["left"].size(), 2U);
  EXPECT_EQ(ranks["left"][1]["busy"], 3);
  EXPECT_FALSE(ranks.contains("right")) << "it has one process";
}

// A block with mean_peak_50us of a force was never reached.
TEST(HistoryMetrics, ALoadHasItsLargestMeanOf50MicrosecondsWhereWindowsTellIt) {
  Table history;
  history.columns = {{"time", "s"}, {"force.y", "N"}, {"body.y", "m"}};
  history.value.resize(3);
  for (int k = 1; k <= 30; ++k) {
    history.value[0].push_back(1e-5 * k);
    history.value[1].push_back(k == 15 ? 10 : k > 10 && k <= 20 ? 5 : 1);
    history.value[2].push_back(k);
  }
  const auto found = metrics_of_column(history, "force.y", 5e-5);
  ASSERT_TRUE(found.contains("mean_peak_50us"));
  EXPECT_NEAR(found.at("mean_peak_50us"), (10 + 4 * 5) / 5.0, 1e-9);
  EXPECT_FALSE(metrics_of_column(history, "body.y", 0).contains("mean_peak_50us")) << "no load";
  for (double& t : history.value[0]) t *= 6;
  EXPECT_FALSE(metrics_of_column(history, "force.y", 0).contains("mean_peak_50us")) << "longer windows";
}

TEST(Summary, TellsForceAndMomentAndForeignColumnsFromTheHistory) {
  Table history;
  history.columns = {{"window", "1"},   {"time", "s"},  {"force.y", "N/m"},     {"moment.z", "N"},
                     {"work_gap", "1"}, {"mid.y", "m"}, {"p_mid", "Pa"},        {"p_mid.max", "Pa"},
                     {"floor.y", "m"},  {"cfl", "1"},   {"energy.kinetic", "J"}};
  for (std::size_t c = 0; c < history.columns.size(); ++c) history.value.push_back({1, 5, 2, 0});
  history.value[1] = {1e-4, 2e-4, 3e-4, 7e-4};
  Summary summary("plate_entry", "");
  summary.describe(history.columns);
  summary.add(window_with(1, true, 0, 0));
  for (int twice = 0; twice < 2; ++twice) summary.take_history(history);
  const auto json = summary.json()["probes"];
  EXPECT_EQ(keys(json), (std::set<std::string>{"mid.y", "p_mid", "force.y", "moment.z", "floor.y"}));
  EXPECT_EQ(json["force.y"]["unit"], "N/m");
  EXPECT_EQ(json["force.y"]["first_peak"], 5);
  EXPECT_EQ(json["force.y"]["time_of_peak"], 2e-4);
  EXPECT_NEAR(json["force.y"]["impulse"].get<double>(), 0.8e-3,
              1e-12);  // 300 µs from the start on: 1, 5, 2 times 0.1 ms
  EXPECT_EQ(json["floor.y"]["final"], 0);
  EXPECT_TRUE(json["floor.y"]["impulse"].is_null()) << "of a length there is none";
}

TEST(HistoryMetrics, EnergiesOfSeveralBodiesAreAccountsTooAndTheirForcesResults) {
  Table history;
  for (const char* name : {"time", "energy.strain", "left.energy.kinetic", "left.failure.damage",
                           "left.body.fy", "left.force.y", "mooring.tension"})
    history.columns.push_back({name, "1"});
  EXPECT_EQ(columns_without_record(history, {}),
            (std::vector<std::string>{"left.body.fy", "left.force.y", "mooring.tension"}));
}

/// A record of 100 windows of 1 ms: 0 for 20, then the force 1, with `blow` in the windows from 50 to `last`.
Table record_with(double blow, int last) {
  Table history;
  history.columns = {{"time", "s"}, {"force.x", "N"}, {"force.y", "N"}, {"moment.z", "N m"}};
  history.value.resize(4);
  for (int k = 0; k < 100; ++k) {
    history.value[0].push_back(1e-3 * (k + 1));
    history.value[1].push_back(k == 30 ? 0.5 : 0);
    history.value[2].push_back(k >= 50 && k <= last ? blow : k < 20 ? 0 : 1);
    history.value[3].push_back(k == 50 ? 1e6 : 0);
  }
  return history;
}

TEST(HistoryMetrics, APeakThatStandsAloneIsABlow) {
  const std::vector<std::string> columns = {"force.x", "force.y", "moment.z"};
  const auto lines = blow_lines(record_with(-12, 51), columns);
  ASSERT_EQ(lines.size(), 1u) << "the largest component alone, and no moment";
  EXPECT_NE(lines[0].find("force.y: the peak of -12 N at 0.051 s lasts 2 windows and is 12 times"),
            std::string::npos)
      << lines[0];
  EXPECT_TRUE(blow_lines(record_with(12, 60), columns).empty()) << "eleven windows resolve it";
  EXPECT_TRUE(blow_lines(record_with(2.5, 50), columns).empty()) << "scatter";
  Table contact = record_with(1, 50);
  contact.value[2][20] = 12;
  EXPECT_TRUE(blow_lines(contact, columns).empty()) << "the first contact";
  EXPECT_TRUE(blow_lines(Table{}, columns).empty());
}

TEST(HistoryMetrics, EachOfSeveralBodiesHasItsImpulseAndItsBlow) {
  Table history = record_with(12, 50);
  history.columns = {{"time", "s"}, {"force.y", "N"}, {"left.force.y", "N"}, {"right.force.y", "N"}};
  history.value[1] = history.value[2];
  history.value[3].assign(100, 1);
  for (const char* body : {"left", "right"}) {
    history.columns.push_back({std::string(body) + ".energy.kinetic", "J"});
    history.value.push_back(history.value[0]);
  }
  const auto lines = blow_lines(history, {"force.y", "left.force.y", "right.force.y"});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].starts_with("left.force.y: the peak of 12 N")) << lines[0];
  const auto impulse = metrics_of_column(history, "right.force.y", 0.01);
  EXPECT_NEAR(impulse.at("impulse"), 3e-4, 1e-12);
}

TEST(HistoryMetrics, ABlowOnOneOfSeveralBodiesIsSaidAndNotThePullOfARope) {
  Table history = record_with(-12, 51);
  for (Column& column : history.columns)
    if (column.name != "time") column.name = "left." + column.name;
  const std::vector<std::string> columns = {"left.force.x", "left.force.y"};
  EXPECT_TRUE(blow_lines(history, columns).empty()) << "a rope has no energy of its own";
  history.columns.push_back({"left.energy.kinetic", "J"});
  history.value.push_back(history.value[0]);
  const auto lines = blow_lines(history, columns);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("left.force.y: the peak of -12 N"), std::string::npos) << lines[0];
}

TEST(HistoryMetrics, MomentIsThatOfACoupleAndDoesNotChangeWhereTheBodyGoes) {
  Points x(3, 3), u = Points::Zero(3, 3), f = Points::Zero(3, 3);
  x << -1, 0.5, 1, 0, 0, 0, 0, 0, 0;
  f(1, 0) = -2;
  f(1, 2) = 2;
  EXPECT_NEAR(moment_about_middle(x, u, f).z(), 4, 1e-14);
  u.row(1).setConstant(-3);
  f(0, 1) = 7;  // along the row of points
  EXPECT_NEAR(moment_about_middle(x, u, f).z(), 4, 1e-14);
  EXPECT_EQ(moment_about_middle(x, Points(3, 0), f).z(), 0);
}

TEST(Summary, ForgetsAResultThatAParticipantWithdraws) {
  Summary summary("plate_entry", "");
  CommittedWindow window = window_with(1, true, 0, 0);
  window.report.structure["mid.y:first_peak"] = -1e-6;
  summary.add(window);
  EXPECT_EQ(summary.json()["probes"]["mid.y"]["first_peak"], -1e-6);
  summary.add(window_with(1, true, 0, 0));
  EXPECT_TRUE(summary.json()["probes"]["mid.y"]["first_peak"].is_null());
}

TEST(Summary, WritesNullForWhatIsUnknownOrNotFinite) {
  Summary summary("plate_entry", "");
  summary.add(window_with(1, true, 0, 0));
  const auto json = summary.json();
  EXPECT_TRUE(json["checks"]["structure_energy_drift"].is_null());
  EXPECT_TRUE(json["particles"]["wall"].is_null());
  EXPECT_EQ(json.dump().find("nan"), std::string::npos);
}

TEST(Summary, KeepsAVerdictThatWasNotReachedApartFromAFailure) {
  Summary summary("plate_entry", "");
  Verdict reached, later;
  reached.result = Verdict::Result::fail;
  reached.value = 2.0;
  summary.verdicts = {reached, later};
  const auto json = summary.json();
  EXPECT_EQ(json["compare"][0]["pass"], false);
  EXPECT_TRUE(json["compare"][1]["pass"].is_null());
  EXPECT_TRUE(json["compare"][1]["value"].is_null());
  EXPECT_EQ(keys(json["compare"][0]), (std::set<std::string>{"probe", "metric", "value", "reference",
                                                             "tolerance", "pass", "kind", "source"}));
}

}  // namespace summary_test
}  // namespace strake
