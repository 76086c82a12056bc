#include "coupler/console/progress_bar.hpp"

#include <gtest/gtest.h>

namespace strake {
namespace progress_bar_test {

Progress plate() {
  return {.time = 0.0135,
          .end_time = 0.03,
          .remaining = 62,
          .steps_per_second = 165.2,
          .iterations = 3,
          .probes = {"mid.y 1.742 mm", "p_mid 989.1 kPa", "p_edge 12 kPa"},
          .waiting = ""};
}

TEST(ProgressRows, SayTimePartRemainderIterationsSpeedAndProbes) {
  const auto rows = progress_rows(plate(), 120, false);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0],
            " 45 % [#############-----------------]  t 0.013500 of 0.03 s  1 min 02 s left  3 iterations"
            "  165 steps/s");
  EXPECT_EQ(rows[1], "   mid.y 1.742 mm   p_mid 989.1 kPa   p_edge 12 kPa");
}

TEST(ProgressRows, AreNeverWiderThanTheTerminal) {
  Progress progress = plate();
  progress.probes.push_back("Kräfte_am_Spant 12.5 kN");
  for (const bool unicode : {false, true})
    for (const bool waits : {false, true}) {
      progress.waiting =
          waits ? "structure: CalculiX computes all 300 windows to 0.003 s (34 %), 25.0 s" : "";
      for (int width = 1; width <= 200; ++width)
        for (const std::string& row : progress_rows(progress, width, unicode))
          EXPECT_LT(display_width(row), width) << row;
    }
}

TEST(ProgressRows, LeaveOutTheLeastImportantFirst) {
  const auto rows = progress_rows(plate(), 60, false);
  EXPECT_NE(rows[0].find("1 min 02 s left"), std::string::npos) << rows[0];
  EXPECT_EQ(rows[0].find("steps/s"), std::string::npos) << rows[0];
  EXPECT_EQ(rows[1], "   mid.y 1.742 mm   p_mid 989.1 kPa   p_edge 12 kPa");
  EXPECT_EQ(progress_rows(plate(), 40, false)[1], "   mid.y 1.742 mm   p_mid 989.1 kPa");
}

TEST(DisplayWidth, CountsLettersNotBytes) {
  EXPECT_EQ(display_width("mid.y"), 5);
  EXPECT_EQ(display_width("Größe µm █"), 10);
  EXPECT_EQ(display_width("\u6c34"), 2);  // a character of two places
  EXPECT_EQ(cut_to_width("Größe", 4), "Größ");
  EXPECT_EQ(cut_to_width("\u6c34\u6c34", 3), "\u6c34");
}

TEST(PaceOfARun, LooksAtItsLastQuarterAndKnowsNothingAtFirst) {
  RecentSpeed pace;
  pace.add(0, 0, 0);
  EXPECT_FALSE(pace.remaining(1));
  pace.add(0.2, 0.1, 10);
  EXPECT_FALSE(pace.remaining(1)) << "a fifth of a second is too short to tell";
  for (double t = 0.4; t < 100; t += 0.2) pace.add(t, 0.005 * t, 50 * t);  // 0.005 s in a second …
  for (double t = 100; t < 200; t += 0.2) pace.add(t, 0.5 + 0.001 * (t - 100), 50 * t);  // … then a fifth
  ASSERT_TRUE(pace.remaining(1));
  EXPECT_NEAR(*pace.remaining(1), 400, 2);  // 0.4 s are left
  EXPECT_NEAR(*pace.steps_per_second(), 50, 0.1);
}

}  // namespace progress_bar_test
}  // namespace strake
