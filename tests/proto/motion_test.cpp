#include "proto/motion.hpp"

#include "proto/error.hpp"
#include "proto/files/motion_file.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strake {
namespace motion_test {

constexpr MotionColumn place = MotionColumn::place, rate = MotionColumn::rate, absent = MotionColumn::absent;

std::vector<double> uneven(int n) {
  std::vector<double> t;
  for (int i = 0; i < n; ++i) t.push_back(0.1 * i + 0.03 * std::sin(2.0 * i));
  return t;
}

template <class Function>
std::vector<double> sampled(const std::vector<double>& t, Function f) {
  std::vector<double> y;
  for (const double s : t) y.push_back(f(s));
  return y;
}

TEST(MotionTable, PlacesOnACubicAreFollowedExactlyBetweenUnevenTimes) {
  const auto t = uneven(12);
  const auto f = [](double s) { return 1 - 2 * s + 3 * s * s - 4 * s * s * s; };
  const MotionTable table(t, {absent, place, absent, absent}, {{{}, sampled(t, f), {}, {}}});
  for (double s = t.front(); s < t.back(); s += 0.013) {
    const RigidMotion m = table.at(s);
    EXPECT_NEAR(m.displacement.y(), f(s), 1e-12);
    EXPECT_NEAR(m.velocity.y(), -2 + 6 * s - 12 * s * s, 1e-11);
    EXPECT_NEAR(m.acceleration.y(), 6 - 24 * s, 1e-9);
    EXPECT_EQ(m.displacement.x(), 0);
  }
}

TEST(MotionTable, AccelerationOfPlacesIsContinuousAcrossEveryTime) {
  const auto t = uneven(9);
  const MotionTable table(
      t, {place, absent, absent, place},
      {{sampled(t, [](double s) { return std::sin(5 * s); }), {}, {}, sampled(t, [](double s) {
          return std::cos(3 * s);
        })}});
  for (std::size_t i = 1; i + 1 < t.size(); ++i) {
    const RigidMotion before = table.at(t[i] - 1e-9), after = table.at(t[i] + 1e-9);
    EXPECT_NEAR(before.acceleration.x(), after.acceleration.x(), 1e-5);
    EXPECT_NEAR(before.angular_acceleration, after.angular_acceleration, 1e-5);
  }
}

TEST(MotionTable, ASineConvergesWithTheFourthPowerOfTheStep) {
  const auto error = [](int n) {
    std::vector<double> t;
    for (int i = 0; i <= n; ++i) t.push_back(2.0 * i / n);
    const MotionTable table(t, {place, absent, absent, absent},
                            {{sampled(t, [](double s) { return std::sin(4 * s); }), {}, {}, {}}});
    double worst = 0;
    for (double s = 0; s < 2; s += 0.0037)
      worst = std::max(worst, std::abs(table.at(s).displacement.x() - std::sin(4 * s)));
    return worst;
  };
  EXPECT_GT(std::log2(error(40) / error(80)), 3.5);
}

TEST(MotionTable, ASpeedThatStopsDoesNotOvershootAndItsWayIsItsIntegral) {
  const MotionTable table({0, 1, 1.2, 2}, {absent, rate, absent, absent}, {{{}, {-6, -6, 0, 0}, {}, {}}});
  double way = 0, before = table.at(0).velocity.y();
  for (int i = 1; i <= 20000; ++i) {
    const double v = table.at(1e-4 * i).velocity.y();
    EXPECT_LE(v, 0);
    EXPECT_GE(v, -6);
    way += 0.5e-4 * (v + before);
    before = v;
  }
  EXPECT_EQ(table.at(0.5).velocity.y(), -6);
  EXPECT_NEAR(table.at(0.5).displacement.y(), -3, 1e-15);
  EXPECT_NEAR(table.at(2).displacement.y(), way, 1e-6);    // trapezoidal rule of the check
  EXPECT_NEAR(table.at(2).displacement.y(), -6.6, 1e-12);  // symmetric ramp
}

TEST(MotionTable, ItsLargestSpeedIsThatUpToATime) {
  const MotionTable table({0, 1, 2}, {rate, rate, absent, absent}, {{{0, 3, 0}, {0, -4, -8}, {}, {}}});
  EXPECT_EQ(table.largest_speed(1), 5);
  EXPECT_EQ(table.largest_speed(2), 8);
  EXPECT_EQ(table.largest_speed(9), 8);
}

TEST(MotionTable, ItsTurnMovesWhatLiesFarFromTheOrigin) {
  const MotionTable table({0, 1, 2}, {rate, absent, absent, rate}, {{{1, 3, 3}, {}, {}, {0, -20, 5}}});
  EXPECT_EQ(table.largest_speed(2), 3);
  EXPECT_EQ(table.largest_speed(2, 0.4), 3 + 8);
}

TEST(MotionTable, BeyondItsEndsItGoesOnWithTheSpeedThere) {
  const MotionTable table({1, 2}, {place, rate, absent, absent}, {{{0, 3}, {2, 4}, {}, {}}});
  EXPECT_NEAR(table.at(3).displacement.x(), 6, 1e-14);
  EXPECT_NEAR(table.at(3).displacement.y(), 7, 1e-14);  // 3 over the table, then 4 m/s
  EXPECT_NEAR(table.at(0.5).displacement.x(), -1.5, 1e-14);
  EXPECT_EQ(table.at(3).acceleration.norm(), 0);
}

MotionTable from_text(const std::string& text) {
  const TemporaryFolder folder;
  put(folder / "motion.csv", text);
  return read_motion(folder / "motion.csv");
}

TEST(MotionFile, ColumnsAreKnownByNameAndAnglesComeInDegrees) {
  const MotionTable table =
      from_text("# a rolling tank\nt [s],angle [deg],vx [m/s]\n0,0,1\n1,90,1\n2,180,1\n");
  EXPECT_NEAR(table.at(1).angle, std::acos(0.0), 1e-15);
  EXPECT_NEAR(table.at(0.7).displacement.x(), 0.7, 1e-15);
  EXPECT_TRUE(table.turns());
  EXPECT_EQ(table.end(), 2);
}

TEST(MotionFile, WhatIsWrongIsSaidWithFileAndRemedy) {
  const auto says = [](const std::string& text, const std::string& part) {
    try {
      from_text(text);
      ADD_FAILURE() << text << " was accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::case_file);
      EXPECT_NE(to_text(e).find("motion.csv"), std::string::npos) << to_text(e);
      EXPECT_NE(to_text(e).find(part), std::string::npos) << to_text(e);
    }
  };
  says("t [s],angel [deg]\n0,0\n1,1\n", "did you mean angle");
  says("t [s],x [mm]\n0,0\n1,1\n", "must be in [m]");
  says("t [s],angle [grad]\n0,0\n1,1\n", "[deg] or [rad]");
  says("t [s],x [m],vx [m/s]\n0,0,1\n1,1,1\n", "another column");
  says("x [m],y [m]\n0,0\n1,1\n", "no column t [s]");
  says("t [s],x [m]\n0,0\n", "needs two");
  says("t [s],x [m]\n0,0\n0,1\n", "row 2");
  says("t [s],x [m]\n0,0\n1,\n", "no finite number");
  says("t [min],x [m]\n0,0\n1,1\n", "[s]");
}

}  // namespace motion_test
}  // namespace strake
