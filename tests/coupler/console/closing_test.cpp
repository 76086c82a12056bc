#include "coupler/console/console.hpp"
#include "coupler/summary/summary.hpp"

#include <gtest/gtest.h>

#include <string>

namespace strake {
namespace closing_test {

// A newcomer asks how fast the body is at the end, and how far it heels. What is held or driven says nothing.
TEST(Closing, TellsTheSpeedAndTheAngleOfABodyThatMovesFreely) {
  Table history;
  history.columns = {
      {"time", "s"},      {"force.y", "N/m"}, {"body.y", "m"},           {"body.angle", "deg"},
      {"body.vx", "m/s"}, {"body.vy", "m/s"}, {"driven.body.vy", "m/s"}, {"driven.body.angle", "deg"}};
  history.value = {{0.1, 0.2, 0.3},  {0, 9, 8},      {1, 0.6, 0.3}, {0, 2, -3},
                   {0, 1e-9, -1e-9}, {-4, -3.5, -3}, {-5, -5, -5},  {0, 0, 0}};
  Summary summary("wedge", "");
  summary.describe(history.columns);
  summary.take_history(history);
  std::string found;
  for (const std::string& line :
       closing_lines({.summary = &summary, .folder = "runs/wedge"}, RunHeader{}, Style{}))
    found += line + "\n";
  EXPECT_NE(found.find("body.angle  peak -3 deg at 300 ms   at the end -3 deg"), std::string::npos) << found;
  EXPECT_NE(found.find("body.vy     peak -4 m/s at 100 ms   at the end -3 m/s"), std::string::npos) << found;
  for (const char* silent : {"body.vx", "body.y ", "driven"})
    EXPECT_EQ(found.find(silent), std::string::npos) << silent << "\n" << found;
}

// The sum of the loads of two hulls alone does not say which one bears them.
TEST(Closing, TellsTheForceOnEachOfSeveralBodies) {
  Table history;
  history.columns = {{"time", "s"},
                     {"force.y", "N/m"},
                     {"left.force.y", "N/m"},
                     {"right.force.y", "N/m"},
                     {"right.force.x", "N/m"},
                     {"mooring.force.y", "N/m"}};
  history.value = {{0.1, 0.2, 0.3}, {0, 9, 8}, {0, 7, 5}, {0, 2, 3}, {0, 1e-9, 0}, {-1, -2, -3}};
  Summary summary("hulls", "");
  summary.describe(history.columns);
  summary.take_history(history);
  std::string found;
  for (const std::string& line :
       closing_lines({.summary = &summary, .folder = "runs/hulls"}, RunHeader{}, Style{}))
    found += line + "\n";
  for (const char* told : {" force.y ", "left.force.y     first peak 7 N/m at 200 ms",
                           "right.force.y    peak 3 N/m", "mooring.force.y  peak -3 N/m"})
    EXPECT_NE(found.find(told), std::string::npos) << told << "\n" << found;
  EXPECT_EQ(found.find("right.force.x"), std::string::npos) << "round-off\n" << found;
}

RunHeader wall_header() {
  RunHeader header;
  ProbeKeys tip;
  tip.name = "tip";
  header.probes = {tip};
  header.columns = {{"tip.x", "m"}, {"tip.y", "m"}};
  return header;
}

std::string names_of(const std::vector<Column>& columns) {
  std::string names;
  for (const Column& column : columns) names += column.name + " ";
  return names;
}

// A wall bends along x: its height tells little.
TEST(Closing, ShowsTheComponentAlongWhichTheBodyBends) {
  RunHeader header = wall_header();
  EXPECT_EQ(names_of(telling_columns(header, 4)), "tip.y ");
  header.thin_axis = 'x';
  EXPECT_EQ(names_of(telling_columns(header, 4)), "tip.x ");
  header.judged = {"force.y", "tip.y"};
  EXPECT_EQ(names_of(telling_columns(header, 4)), "tip.y ");
  header.judged = {"tip.x", "tip.y"};
  EXPECT_EQ(names_of(telling_columns(header, 4)), "tip.x tip.y ");
}

TEST(Closing, TellsAComponentThatGrewLargerThanTheOneOfTheTable) {
  Table history;
  history.columns = {{"time", "s"}, {"tip.x", "m"}, {"tip.y", "m"}};
  const auto told = [&](double x, double y) {
    history.value = {{0.1, 0.2, 0.3}, {0, x, 0}, {0, y, 0}};
    Summary summary("wall", "");
    summary.describe(history.columns);
    summary.take_history(history);
    std::string all;
    for (const std::string& line :
         closing_lines({.summary = &summary, .folder = "runs/wall"}, wall_header(), Style{}))
      all += line + "\n";
    return all;
  };
  EXPECT_NE(told(0.04, -0.01).find("tip.x  first peak 40 mm"), std::string::npos) << told(0.04, -0.01);
  EXPECT_NE(told(0.04, -0.01).find("tip.y  first peak -10 mm"), std::string::npos);
  EXPECT_EQ(told(0.001, -0.01).find("tip.x"), std::string::npos) << told(0.001, -0.01);
  EXPECT_EQ(told(0.04, -1e-17).find("tip.y"), std::string::npos) << told(0.04, -1e-17);
}

}  // namespace closing_test
}  // namespace strake
