#include "coupler/summary/notes.hpp"
#include "coupler/summary/summary.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace strake {
namespace alarms_test {

std::map<std::string, double> raised(const std::string& kind, double time) {
  const std::string name = "alarm." + kind + ".";
  return {{name + "time", time}, {name + "x", 0.125},  {name + "y", -0.25},  {name + "z", 0},
          {name + "value", 91},  {name + "bound", 76}, {name + "step", 2e-6}};
}

TEST(Alarms, SayTimePlaceCauseAndRemedyInOneLine) {
  auto monitor = raised("speed", 0.00528);
  monitor["alarm.flow_step"] = 8e-5;
  const auto alarms = alarms_of(monitor);
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_EQ(alarms[0].line,
            "t = 0.00528 s at (0.125, -0.25, 0) m: water at 91 m/s, where this flow gives at most 76; "
            "probably single "
            "particles between jet and wall, in steps of 2e-06 s that are short for this flow; try "
            "fluid.scheme.time_step = 8e-05 with a window as long, or half of fluid.spacing");
  monitor["alarm.flow_step"] = 4e-6;
  EXPECT_NE(alarms_of(monitor)[0].line.find("too coarse for the jet"), std::string::npos)
      << "steps of the flow's own length are not the suspect";
  EXPECT_EQ(json_of(alarms[0])["at"], (nlohmann::ordered_json{0.125, -0.25, 0}));
}

TEST(PreciceNotes, TellEachSideOnceThatItReadsAtTheStartAlone) {
  PreciceNotes notes(0.01);
  EXPECT_TRUE(notes.look("fluid", {{"seconds.solve", 1}}).empty());
  const auto lines = notes.look("structure", {{"precice.start_read", 0.25}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].starts_with("structure: in the window from t = 0.25 s it read")) << lines[0];
  EXPECT_TRUE(notes.look("structure", {{"precice.start_read", 0.25}}).empty());
  EXPECT_EQ(notes.look("fluid", {{"precice.start_read", 0}}).size(), 1u);
}

TEST(PreciceNotes, TellEachSideOnceThatItsConfigurationHasOtherWindows) {
  PreciceNotes notes(0.01);
  EXPECT_TRUE(notes.look("fluid", {{"precice.window", 0.01}}).empty());
  const auto lines = notes.look("structure", {{"precice.window", 0.025}});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(
      lines[0],
      "structure: its preCICE configuration has time-window-size = 0.025 s, and the windows of this run "
      "are 0.01 s long (coupling.surface.window), which hold; make the two equal");
  EXPECT_TRUE(notes.look("structure", {{"precice.window", 0.025}}).empty());
}

TEST(Alarms, WithoutAPlaceSayNone) {
  const auto alarms = alarms_of(
      {{"alarm.momentum.time", 0.01}, {"alarm.momentum.value", 0.3}, {"alarm.momentum.bound", 0.1}});
  ASSERT_EQ(alarms.size(), 1u);
  EXPECT_TRUE(alarms[0].line.starts_with("t = 0.01 s: 30 % of the momentum has no source, more than 10 %"))
      << alarms[0].line;
  EXPECT_TRUE(json_of(alarms[0])["at"].is_null());
}

TEST(Alarms, AreToldOnceAndNotAgainAfterAResume) {
  AlarmNotes notes(0), resumed(0.1);
  auto monitor = raised("pressure", 0.05);
  EXPECT_TRUE(notes.look({}).empty());
  EXPECT_EQ(notes.look(monitor).size(), 1u);
  EXPECT_TRUE(notes.look(monitor).empty());
  monitor.merge(raised("dry", 0.2));
  EXPECT_EQ(notes.look(monitor).size(), 1u);
  EXPECT_EQ(resumed.look(monitor).size(), 1u) << "the one of 0.05 s was told before";
}

TEST(Alarms, StandInTheSummaryTheEarliestFirst) {
  CommittedWindow window;
  window.report.fluid = raised("speed", 0.2);
  window.report.fluid.merge(raised("dry", 0.1));
  Summary summary("wedge", "");
  EXPECT_TRUE(summary.json()["alarms"].empty());
  summary.add(window);
  const auto alarms = summary.json()["alarms"];
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_EQ(alarms[0]["kind"], "dry");
  EXPECT_EQ(alarms[1]["kind"], "speed");
  EXPECT_EQ(summary.alarms().size(), 2u);
}

TEST(CheckGrades, AreGoodPoorAndBadByTheirBounds) {
  const auto grade = [](const char* key, double value, double particles = 1000) {
    const auto grades = grades_of({{key, value}}, particles);
    return grades.contains(key) ? grades[key]["grade"].get<std::string>() : "none";
  };
  EXPECT_EQ(grade("momentum_gap", 0.02), "good");
  EXPECT_EQ(grade("momentum_gap", 0.06), "poor");
  EXPECT_EQ(grade("momentum_gap", 0.11), "bad");
  EXPECT_EQ(grade("volume_drift", -0.06), "bad") << "a loss counts as a gain does";
  EXPECT_EQ(grade("largest_speed", 0.76), "good");
  EXPECT_EQ(grade("largest_speed", 1.01), "bad");
  EXPECT_EQ(grade("openings", 1), "good");
  EXPECT_EQ(grade("openings", 1, 100), "poor") << "a share of the particles";
  EXPECT_EQ(grade("voids", 1000), "none") << "waves may shut in air";
  EXPECT_TRUE(grades_of({{"momentum_gap", nullptr}}, 1000).empty());
}

TEST(CheckGrades, AreToldWorstFirstWithTheirBounds) {
  nlohmann::ordered_json checks = {{"work_gap", 3e-14}, {"momentum_gap", 0.055}, {"largest_speed", 1.1}};
  checks["grades"] = grades_of(checks, 1000);
  EXPECT_EQ(grade_lines(checks),
            (std::vector<std::string>{"bad   water's speed 110 % of its bound (at most 100 %)",
                                      "poor  momentum gap 5.5e-02 (good to 0.02, bad from 0.1)",
                                      "good  work gap 3.0e-14 (to 1e-06)"}));
}

TEST(EmptyCellNotes, TellOnceWhichValueIsNoNumber) {
  const double nan = std::nan("");
  EmptyCellNotes notes({"floor.y", "left.force", "structure.force"});
  EXPECT_TRUE(notes.look("structure", 0.1, false, {{"floor.y", 1}, {"other", nan}}).empty());
  const auto lines = notes.look("structure", 0.2, false, {{"floor.y", nan}, {"force", nan}});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0],
            "structure: floor.y is no number (nan) at t = 0.2 s; such cells of history.csv stay empty");
  EXPECT_EQ(lines[1].substr(0, 33), "structure: structure.force is no ");
  EXPECT_TRUE(notes.look("structure", 0.3, false, {{"floor.y", nan}, {"force", nan}}).empty());
  EXPECT_TRUE(notes.look("right", 0.3, true, {{"left.force", nan}}).empty()) << "another body's";
  EXPECT_EQ(notes.look("left", 0.3, true, {{"left.force", nan}}).size(), 1U);
}

}  // namespace alarms_test
}  // namespace strake
