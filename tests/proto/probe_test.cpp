#include "proto/probe.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace strake {
namespace probe_test {

constexpr double pi = std::numbers::pi;
constexpr double micro = 1e-6;

/// Feeds the mean of a signal over each step (mid-point value: exact for lines).
void feed(ProbeRecord& record, double from, double to, double step, const std::function<double(double)>& q) {
  const auto n = static_cast<int>(std::lround((to - from) / step));
  for (int i = 0; i < n; ++i) record.add(from + i * step, from + (i + 1) * step, q(from + (i + 0.5) * step));
}

TEST(ProbeRecord, HalfSineHasItsPeakItsImpulseAndItsLargestMean) {
  constexpr double p0 = 5e6, duration = 200 * micro, start = 1e-3, step = 0.5 * micro;
  const auto signal = [&](double t) {
    return t < start || t > start + duration ? 0.0 : p0 * std::sin(pi * (t - start) / duration);
  };
  ProbeRecord record = ProbeRecord::waiting_for_contact();
  feed(record, 0, start, step, signal);
  record.contact(start);
  feed(record, start, start + 400 * micro, step, signal);
  ASSERT_TRUE(record.first_peak());
  EXPECT_NEAR(record.first_peak()->value, p0, 1e-4 * p0);
  EXPECT_NEAR(record.first_peak()->time, start + duration / 2, step);
  EXPECT_EQ(record.peak()->value, record.first_peak()->value);
  // ∫ p0 sin(π t/T) dt = 2 p0 T/π; the mid-point rule errs by (π step/T)²/24 = 2.6e-6.
  ASSERT_TRUE(record.impulse());
  EXPECT_NEAR(*record.impulse(), 2 * p0 * duration / pi, 1e-5 * p0 * duration);
  // Mean over w around the crest: p0 sin(x)/x with x = π w/(2T).
  const double x = pi * 50 * micro / (2 * duration);
  ASSERT_TRUE(record.mean_peak_50us());
  EXPECT_NEAR(*record.mean_peak_50us(), p0 * std::sin(x) / x, 1e-4 * p0);
}

TEST(ProbeRecord, PlateauIsAPeakOnlyOnceItFellBelowFourFifths) {
  ProbeRecord record;
  feed(record, 0, 100 * micro, micro, [](double) { return 10.0; });
  EXPECT_FALSE(record.first_peak());
  feed(record, 100 * micro, 200 * micro, micro, [](double) { return 8.0; });  // 0.8 is not below 0.8
  EXPECT_FALSE(record.first_peak());
  record.add(200 * micro, 201 * micro, 7.99);
  ASSERT_TRUE(record.first_peak());
  EXPECT_EQ(record.first_peak()->value, 10);
  EXPECT_EQ(record.first_peak()->time, micro);  // when it was first reached
}

TEST(ProbeRecord, FirstOfTwoPeaksCountsFromFivePercentOfTheLargest) {
  for (const double first : {4.9, 5.1}) {
    ProbeRecord record;
    record.add(0, 1, first);
    record.add(1, 2, 0);
    ASSERT_TRUE(record.first_peak());  // all that is known so far
    EXPECT_EQ(record.first_peak()->value, first);
    record.add(2, 3, 100);
    EXPECT_EQ(record.first_peak().has_value(), first > 5);
    record.add(3, 4, 0);
    EXPECT_EQ(record.first_peak()->value, first > 5 ? first : 100);
    EXPECT_EQ(record.peak()->value, 100);
  }
}

TEST(ProbeRecord, ARisingWiggleIsNoPeakBeforeItFalls) {
  ProbeRecord record;
  for (const double q : {1.0, 0.9, 2.0, 1.7, 3.0, 2.5}) record.add(q, q, q);
  EXPECT_FALSE(record.first_peak());
}

TEST(ProbeRecord, NegativeValuesKeepTheirSign) {
  ProbeRecord record;
  for (const double q : {0.0, -1.0, -3.0, -0.5, 2.0}) record.add(0, 0, q);
  EXPECT_EQ(record.first_peak()->value, -3);
  EXPECT_EQ(record.peak()->value, -3);
  EXPECT_EQ(record.last(), 2);
}

TEST(ProbeRecord, OneStepSpikeIsPeakAndImpulse) {
  // With c = infinity the first contact is one step wide: its step must count whole.
  constexpr double step = 2 * micro, spike = 6.472e8;
  for (const bool told_before_the_step : {true, false}) {
    ProbeRecord record = ProbeRecord::waiting_for_contact();
    feed(record, 0, 100 * micro, step, [](double) { return 10.0; });
    if (told_before_the_step) record.contact(100 * micro);
    record.add(100 * micro, 102 * micro, spike);
    if (!told_before_the_step) record.contact(100 * micro);
    feed(record, 102 * micro, 500 * micro, step, [](double) { return 0.0; });
    ASSERT_TRUE(record.first_peak());
    EXPECT_EQ(record.first_peak()->value, spike);
    ASSERT_TRUE(record.impulse());
    EXPECT_NEAR(*record.impulse(), spike * step, 1e-9 * spike * step);
    EXPECT_NEAR(*record.mean_peak_50us(), spike * step / (50 * micro), 1e-9 * spike);
  }
}

TEST(ProbeRecord, AStepAcrossTheEndOfTheImpulseCountsByItsShare) {
  ProbeRecord record;
  record.add(0, 200 * micro, 1e6);
  EXPECT_FALSE(record.impulse());
  record.add(200 * micro, 600 * micro, 4e6);  // a quarter of it lies before 300 µs
  ASSERT_TRUE(record.impulse());
  EXPECT_NEAR(*record.impulse(), 200 + 400, 1e-9);
  EXPECT_NEAR(record.running_impulse(), 200 + 1600, 1e-9);
}

TEST(ProbeRecord, AStepAcrossContactCountsFromContact) {
  ProbeRecord record = ProbeRecord::waiting_for_contact();
  record.add(0, 1e-3, 5);
  record.contact(0.75e-3);
  EXPECT_NEAR(record.running_impulse(), 5 * 0.25e-3, 1e-15);
}

TEST(ProbeRecord, StepsMuchLongerThanTheImpulseKeepTheirMean) {
  ProbeRecord record;
  record.add(0, 0.1, 7);
  ASSERT_TRUE(record.impulse());
  EXPECT_NEAR(*record.impulse(), 7 * 300 * micro, 1e-15);
  EXPECT_NEAR(*record.mean_peak_50us(), 7, 1e-12);
  EXPECT_NEAR(record.running_impulse(), 0.7, 1e-15);
}

TEST(ProbeRecord, ImpulseIsKnownAfterExactlyThreeStepsOfAHundredMicroseconds) {
  ProbeRecord record = ProbeRecord::waiting_for_contact();
  const double start = 19 * 1e-4;  // not a sum that rounds nicely
  record.contact(start);
  double t = start;
  for (int i = 0; i < 3; ++i, t += 1e-4) record.add(t, t + 1e-4, 1e6);
  ASSERT_TRUE(record.impulse());
  EXPECT_NEAR(*record.impulse(), 300, 1e-6);
}

TEST(ProbeRecord, LargestMeanIsFoundBetweenTheEndsOfSteps) {
  // 40 µs of 1 across the boundary of long steps of 30 µs of 0. The best window contains the 40 and any 10
  // beside it.
  ProbeRecord record;
  record.add(0, 33 * micro, 0);
  record.add(33 * micro, 73 * micro, 1);
  record.add(73 * micro, 173 * micro, 0.5);
  EXPECT_NEAR(*record.mean_peak_50us(), (40 * 1 + 10 * 0.5) / 50, 1e-12);
}

TEST(ProbeRecord, WaitingForContactReportsNeitherFirstPeakNorImpulse) {
  ProbeRecord record = ProbeRecord::waiting_for_contact();
  feed(record, 0, 1e-3, micro, [](double t) { return std::sin(2 * pi * t / 200e-6); });
  EXPECT_FALSE(record.in_contact());
  EXPECT_FALSE(record.first_peak() || record.impulse() || record.mean_peak_50us());
  std::map<std::string, double> monitor;
  record.report("p", monitor);
  EXPECT_EQ(monitor.size(), 3u);
  EXPECT_TRUE(monitor.contains("p:peak") && monitor.contains("p:time_of_peak") &&
              monitor.contains("p:final"));
}

TEST(ProbeRecord, ContactForgetsWhatCameBeforeAndIsSetOnce) {
  ProbeRecord record;
  record.add(0, 1, 50);
  record.add(1, 2, 0);
  record.contact(2);
  record.contact(1);
  EXPECT_FALSE(record.first_peak());
  record.add(2, 3, 10);
  record.add(3, 4, 0);
  EXPECT_EQ(record.first_peak()->value, 10);
  EXPECT_EQ(record.peak()->value, 50);  // of the whole record
  std::map<std::string, double> monitor;
  record.report("p", monitor);
  EXPECT_EQ(monitor.at("p:contact"), 2);
  EXPECT_EQ(monitor.at("p:running_impulse"), 10);
}

TEST(ProbeRecord, WindowHoldsExtremesAndTimeWeightedMeanOfItsSteps) {
  ProbeRecord record;
  record.add(0, 1, 100);
  record.new_window();
  EXPECT_EQ(record.window_mean(), 100);  // nothing new: the last value stands
  record.add(1, 2, -1);
  record.add(2, 5, 3);
  EXPECT_EQ(record.window_min(), -1);
  EXPECT_EQ(record.window_max(), 3);
  EXPECT_EQ(record.window_mean(), 2);
}

TEST(ProbeRecord, SavedAndLoadedAnywhereItGoesOnBitForBit) {
  const auto signal = [](double t) {
    return 1e5 * std::sin(t * 9e4) * std::exp(-t * 3e3) + 17 * std::cos(t * 1e6);
  };
  const auto result = [](const ProbeRecord& record) {
    std::map<std::string, double> monitor;
    record.report("p", monitor);
    monitor["window"] = record.window_mean() + 3 * record.window_min() + 7 * record.window_max();
    return monitor;
  };
  for (const int cut : {0, 1, 40, 150, 399}) {
    ProbeRecord whole = ProbeRecord::waiting_for_contact(), part = whole;
    for (int i = 0; i < 400; ++i) {
      if (i == cut) {
        Archive archive;
        part.save("probe.p", archive);
        part = ProbeRecord();
        part.load("probe.p", archive);
      }
      for (ProbeRecord* record : {&whole, &part}) {
        if (i == 100) record->contact(i * micro * 1.7);
        if (i % 30 == 0) record->new_window();
        record->add(i * micro * 1.7, (i + 1) * micro * 1.7, signal(i * micro));
      }
      ASSERT_EQ(result(whole), result(part)) << "cut " << cut << ", step " << i;
    }
    EXPECT_TRUE(whole.impulse() && whole.first_peak());
  }
}

TEST(ProbeRecord, LoadNamesTheProbeThatACheckpointLacks) {
  ProbeRecord record;
  try {
    record.load("mid", Archive());
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(to_text(error).find("no record of the probe mid"), std::string::npos);
  }
}

}  // namespace probe_test
}  // namespace strake
