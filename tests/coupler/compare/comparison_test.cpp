#include "coupler/compare/comparison.hpp"

#include "proto/error.hpp"
#include "tests/proto/refusal.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace strake {
namespace comparison_test {

constexpr double pi = std::numbers::pi;

/// A record of q(t) at equal steps.
template <class Q>
Record record_of(double to, int rows, Q q, const std::string& name = "a") {
  Record r = {.name = name, .unit = "m", .curve = {}, .means = {}, .contact = {}};
  for (int k = 0; k <= rows; ++k) {
    r.curve.time.push_back(to * k / rows);
    r.curve.value.push_back(q(r.curve.time.back()));
  }
  return r;
}

const MetricRow& row_of(const Comparison& c, const std::string& name) {
  for (const MetricRow& row : c.rows)
    if (row.name == name) return row;
  throw std::runtime_error("no metric " + name);
}

std::string file_with(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const auto path = folder.path() / name;
  std::ofstream(path) << text;
  return path.string();
}

TEST(Comparison, TellsTheMetricsOfTwoSines) {
  const auto wave = [](double amplitude) {
    return [amplitude](double t) { return amplitude * std::sin(2 * pi * 5 * t); };
  };
  const Comparison c = compare_records({record_of(1, 2000, wave(2)), record_of(1, 2000, wave(2.2))}, "q", {});
  EXPECT_NEAR(*row_of(c, "first_peak").value[0], 2, 1e-4);
  EXPECT_NEAR(*row_of(c, "first_peak").deviation[1], 0.1, 1e-6);
  EXPECT_NEAR(*row_of(c, "time_of_first_peak").value[1], 0.05, 1e-3);
  EXPECT_NEAR(*row_of(c, "frequency").value[0], 5, 1e-3);
  EXPECT_NEAR(*row_of(c, "rms").value[0], std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(*row_of(c, "l2").deviation[1], 0.1, 1e-6);
  EXPECT_GT(*row_of(c, "dtw").deviation[1], 0.01);
  EXPECT_FALSE(row_of(c, "l2").value[0]);
}

TEST(Comparison, GivesNoPercentageOfValuesAboutZero) {
  const auto load = [](double size) { return record_of(1, 10, [=](double) { return size; }); };
  std::vector<Comparison> made = {compare_records({load(1e-7), load(-2)}, "force.x", {}),
                                  compare_records({load(1000), load(1100)}, "force.y", {}),
                                  compare_records({load(30), load(33)}, "force.z", {}),
                                  compare_records({load(1e-7), load(2)}, "moment.z", {})};
  find_small_components({"force.x", "force.y", "force.z", "moment.z"}, made);
  EXPECT_EQ(deviation_text(row_of(made[0], "mean"), 1), "-0.2 % *");
  EXPECT_EQ(deviation_text(row_of(made[1], "mean"), 1), "+10 %");
  EXPECT_EQ(deviation_text(row_of(made[2], "mean"), 1), "+10 %");
  EXPECT_EQ(deviation_text(row_of(made[3], "rms"), 1), "(1) small") << "no component beside it";
  EXPECT_EQ(deviation_text(row_of(made[0], "time_of_peak"), 1), "");
  EXPECT_NEAR(*row_of(made[0], "mean").deviation[1], -0.002, 1e-9) << "held to that by --within too";
  EXPECT_NEAR(*row_of(made[0], "l2").value[1], 0.002, 1e-9);
  EXPECT_NEAR(*row_of(made[1], "l2").value[1], 0.1, 1e-9);
  ASSERT_EQ(deviation_notes("force.x", made[0]).size(), 1U);
  EXPECT_NE(deviation_notes("force.x", made[0]).front().find("force.x is below 1 % of force.y in (1)"),
            std::string::npos);
  EXPECT_TRUE(deviation_notes("force.y", made[1]).empty());
  EXPECT_EQ(deviation_notes("moment.z", made[3]).size(), 1U);
}

TEST(Comparison, NoiseHasNoFrequency) {
  unsigned state = 1;
  const auto noise = [&](double) {
    return static_cast<double>((state = state * 1664525u + 1013904223u) >> 16);
  };
  const Comparison c = compare_records({record_of(1, 500, noise), record_of(1, 500, noise)}, "q", {});
  EXPECT_FALSE(row_of(c, "frequency").value[0]);
  EXPECT_FALSE(row_of(c, "frequency").value[1]);
}

TEST(Comparison, ZerosHaveNoTimeOfTheirPeak) {
  const auto zeros = record_of(1, 20, [](double) { return 0.0; });
  const Comparison c = compare_records({zeros, zeros}, "q", {});
  EXPECT_EQ(*row_of(c, "peak").value[0], 0);
  EXPECT_FALSE(row_of(c, "time_of_peak").value[0]);
}

TEST(Comparison, UnitsOfMetricsFollowFromThatOfTheQuantity) {
  EXPECT_EQ(metric_unit("peak", "N/m"), "N/m");
  EXPECT_EQ(metric_unit("impulse", "Pa"), "Pa s");
  EXPECT_EQ(metric_unit("slope", "m"), "m/s");
  EXPECT_EQ(metric_unit("slope", "m/s"), "m/s^2");
  EXPECT_EQ(metric_unit("slope", "N/m"), "N/m/s");
  EXPECT_EQ(metric_unit("slope", "1"), "1/s");
  EXPECT_EQ(metric_unit("drift", "m"), "m");
}

TEST(Comparison, TakesTheSpanThatAllRecordsCover) {
  const auto line = [](double t) { return t; };
  const Comparison c =
      compare_records({record_of(1, 10, line), record_of(0.5, 7, line)}, "q", {.from = 0.1, .to = {}});
  EXPECT_DOUBLE_EQ(c.from, 0.1);
  EXPECT_DOUBLE_EQ(c.to, 0.5);
  EXPECT_NEAR(*row_of(c, "impulse").value[0], 0.12, 1e-12);
  EXPECT_NEAR(*row_of(c, "l2").deviation[1], 0, 1e-12);
}

TEST(Comparison, ImpulseOfARunCountsWhatHappensWithinItsWindows) {
  // A spike inside the second window: its end values are zero, its mean is not.
  Record r = record_of(0.3, 3, [](double) { return 0.0; });
  r.means = {{0.1, 0.2, 0.3}, {0, 7, 0}};
  const Comparison c = compare_records({r, r}, "p", {});
  EXPECT_NEAR(*row_of(c, "impulse").value[0], 0.7, 1e-12);
}

// Each row has the mean force of its window: 0.1 (1 + 2 + 6) from 0.1 s on, not the 0.85 of straight lines.
TEST(Comparison, ImpulseOfALoadIsThatOfItsWindows) {
  const TemporaryFolder folder;
  file_with(folder, "history.csv",
            "window [1],time [s],left.force.y [N/m],left.body.vy [m/s]\n"
            "1,0.1,0,1\n2,0.2,1,1\n3,0.3,2,1\n4,0.4,6,1\n");
  const RecordSource run(folder.path().string());
  const Record load = run.record("left.force.y"), speed = run.record("left.body.vy");
  EXPECT_NEAR(*row_of(compare_records({load, load}, "q", {}), "impulse").value[0], 0.9, 1e-12);
  EXPECT_NEAR(*row_of(compare_records({load, load}, "q", {}), "mean").value[0], 3, 1e-12);
  EXPECT_EQ(speed.means.size(), 0u);
  file_with(folder, "summary.json", R"({"probes": {"left.force.y": {"peak": 6, "time_of_peak": 0.4},
                                                   "left.body.vy": {"peak": 1, "time_of_peak": 0.1}}})");
  EXPECT_EQ(RecordSource(folder.path().string()).telling_quantities(),
            (std::vector<std::string>{"left.force.y"}));
}

TEST(Comparison, TakesThePeaksOfTheStepsWhereARunHasThem) {
  const TemporaryFolder folder;
  file_with(folder, "history.csv",
            "window [1],time [s],force.y [N/m],p [Pa],p.mean [Pa],p.min [Pa],p.max [Pa],cfl [1]\n"
            "1,0.1,1,0,1,0,2,0.1\n2,0.2,2,1,3,0,9,0.1\n3,0.3,3,0,0,-1,1,0.1\n4,0.4,2,0,0,-12,0,0.1\n");
  const RecordSource killed(folder.path().string());  // without summary.json
  EXPECT_EQ(killed.telling_quantities().size(), 6u);
  const Record of_windows = killed.record("p");
  const Comparison rough = compare_records({of_windows, of_windows}, "p", {});
  EXPECT_EQ(row_of(rough, "peak").value[0], -12);
  EXPECT_EQ(row_of(rough, "time_of_peak").value[0], 0.4 - 0.1);
  EXPECT_EQ(row_of(rough, "first_peak").value[0], 9);
  file_with(folder, "summary.json",
            R"({"probes": {"p": {"unit": "Pa", "first_peak": 9.5, "time_of_first_peak": 0.15,
                                 "peak": -12.5, "time_of_peak": 0.35}}})");
  const RecordSource run(folder.path().string());
  EXPECT_EQ(run.telling_quantities(), (std::vector<std::string>{"force.y", "p"}));
  const Record record = run.record("p");
  const Comparison c = compare_records({record, record}, "p", {});
  EXPECT_EQ(row_of(c, "first_peak").value[0], 9.5);
  EXPECT_EQ(row_of(c, "peak").value[0], -12.5);
  EXPECT_NEAR(*row_of(c, "time_of_peak").value[0], 0.25, 1e-12);
  const Comparison early = compare_records({record, record}, "p", {.from = {}, .to = 0.3});
  EXPECT_EQ(row_of(early, "peak").value[0], 9);  // the run's own peak comes later
  const Comparison late = compare_records({record, record}, "p", {.from = 0.2, .to = {}});
  EXPECT_EQ(row_of(late, "peak").value[0], -12.5);
}

TEST(Comparison, ShiftsByContactByPeakOrBySeconds) {
  const auto hump = [](double at) {
    return [at](double t) { return std::exp(-std::pow((t - at) / 0.02, 2)); };
  };
  Record one = record_of(1, 1000, hump(0.3)), two = record_of(1, 1000, hump(0.42));
  one.contact = 0.25;
  two.contact = 0.36;
  EXPECT_NEAR(shift_onto(one, two, "peak"), -0.12, 1e-12);
  EXPECT_NEAR(shift_onto(one, two, "contact"), -0.11, 1e-12);
  EXPECT_DOUBLE_EQ(shift_onto(one, two, "-0.5"), -0.5);
  text_of_error([&] { shift_onto(one, two, "soon"); }, ExitCode::command_line);
  two.shift(-0.12);
  const Comparison c = compare_records({one, two}, "q", {});
  EXPECT_TRUE(c.after_contact);
  EXPECT_NEAR(*row_of(c, "l2").deviation[1], 0, 1e-9);
}

TEST(Comparison, RefusesRecordsWithoutCommonTimeOrUnit) {
  const auto one = [](double) { return 1.0; };
  Record early = record_of(1, 10, one), late = early, other = early;
  late.shift(5);
  other.unit = "Pa";
  const auto refused = [&early](const Record& with) {
    return text_of_error([&] { compare_records({early, with}, "q", {}); }, ExitCode::command_line);
  };
  EXPECT_NE(refused(late).find("share no time"), std::string::npos);
  EXPECT_NE(refused(other).find("\"Pa\""), std::string::npos);
}

TEST(Record, OfAFileIsInSiUnitsWhateverItsColumnIsCalled) {
  const TemporaryFolder folder;
  const std::string path =
      file_with(folder, "ansys.csv", "# exported\ntime [ms],uy [mm]\n0,0\n1,2.5\n2,\n3,5\n");
  const Record r = RecordSource(path).record("mid.y");
  EXPECT_EQ(r.unit, "m");
  ASSERT_EQ(r.curve.size(), 3u);  // the line without a value is left out
  EXPECT_DOUBLE_EQ(r.curve.time[2], 3e-3);
  EXPECT_DOUBLE_EQ(r.curve.value[1], 2.5e-3);
}

TEST(Record, ChoosesAColumnBehindAColon) {
  const TemporaryFolder folder;
  const std::string path = file_with(folder, "two.csv", "time [s],a [m],b [kPa]\n0,1,2\n1,3,4\n");
  const Record r = RecordSource(path + ":b").record("p_mid");
  EXPECT_EQ(r.unit, "Pa");
  EXPECT_DOUBLE_EQ(r.curve.value[1], 4000);
  EXPECT_FALSE(RecordSource(path).has("p_mid"));
  expect_refused([&] { RecordSource(path + ":c"); }, "no column c");
}

TEST(Record, RefusesWhatCannotBeACurveWithItsPlace) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& text) {
    const std::string path = file_with(folder, "x.csv", text);
    return text_of_error([&] { RecordSource(path).record("q"); }, ExitCode::case_file);
  };
  EXPECT_NE(problem("time [s],q [m]\n0,1\n0,2\n").find("do not ascend"), std::string::npos);
  EXPECT_NE(problem("x [m],q [m]\n0,1\n1,2\n").find("is in \"m\""), std::string::npos);
  EXPECT_NE(problem("time [s],q [m]\n0,1\n").find("1 values"), std::string::npos);
  EXPECT_NE(problem("time [s]\n0\n1\n").find("one column"), std::string::npos);
  expect_refused([] { RecordSource("nowhere.csv"); }, "no such");
}

}  // namespace comparison_test
}  // namespace strake
