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

}  // namespace
}  // namespace strake
