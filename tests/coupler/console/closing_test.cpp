#include "coupler/console/console.hpp"
#include "coupler/summary/summary.hpp"

#include <gtest/gtest.h>

#include <string>

namespace strake {
namespace {

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

}  // namespace
}  // namespace strake
