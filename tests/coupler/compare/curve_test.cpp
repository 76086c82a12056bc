#include "coupler/compare/curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace strake {
namespace curve_test {

Curve sampled(const std::function<double(double)>& q, double from, double to, int n) {
  Curve curve;
  for (int k = 0; k <= n; ++k) {
    curve.time.push_back(from + (to - from) * k / n);
    curve.value.push_back(q(curve.time.back()));
  }
  return curve;
}

TEST(Curve, IsLinearBetweenSamplesAndHeldOutside) {
  const Curve c = {{0, 1, 3}, {2, 4, 0}};
  EXPECT_EQ(value_at(c, -1), 2);
  EXPECT_EQ(value_at(c, 0.5), 3);
  EXPECT_EQ(value_at(c, 2), 2);
  EXPECT_EQ(value_at(c, 9), 0);
  EXPECT_EQ(resample(c, {1, 2}).value, (std::vector<double>{4, 2}));
}

TEST(Curve, IntegratesPiecewiseLinearFunctionsExactlyOverAnyWindow) {
  const Curve c = {{0, 1, 3}, {2, 4, 0}};
  EXPECT_DOUBLE_EQ(impulse(c, 0, 3), 7);
  EXPECT_DOUBLE_EQ(impulse(c, 0.5, 2), 1.75 + 3);
  EXPECT_DOUBLE_EQ(mean(c, 0.5, 2), 4.75 / 1.5);
  EXPECT_DOUBLE_EQ(rms({{0, 1}, {0, 1}}, 0, 1), std::sqrt(1 / 3.0));
}

TEST(Curve, HasThePeakWithItsSign) {
  const auto p = peak({{0, 1, 2, 3}, {1, -5, 5, 2}});
  ASSERT_TRUE(p);
  EXPECT_EQ(p->value, -5);
  EXPECT_EQ(p->time, 1);
  EXPECT_FALSE(peak({}));
}

// Two pulses, the second twice the first. The first peak is that of the first pulse, since q falls below 0.8
// of it.
TEST(Curve, FindsTheFirstPeakThatFallsBelowFourFifthsOfItself) {
  const auto pulses = [](double t) {
    return -std::exp(-100 * (t - 1) * (t - 1)) - 2 * std::exp(-100 * (t - 2) * (t - 2));
  };
  const auto first = first_peak(sampled(pulses, 0, 3, 3000), 0);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->time, 1, 1e-3);
  EXPECT_NEAR(first->value, -1, 1e-5);
  EXPECT_NEAR(first_peak(sampled(pulses, 0, 3, 3000), 1.5)->value, -2, 1e-4);
}

TEST(Curve, PassesOverRipplesAndOverPeaksBelowFivePercentOfTheRecord) {
  const Curve ripples = {{0, 1, 2, 3, 4, 5}, {0, 1, 0.85, 2, 0.5, 1}};
  EXPECT_EQ(first_peak(ripples, 0)->value, 2);
  const Curve faint = {{0, 1, 2, 3, 4}, {0, 0.1, 0, 10, 1}};
  EXPECT_EQ(first_peak(faint, 0)->value, 10);
  EXPECT_FALSE(first_peak({{0, 1, 2}, {0, 1, 2}}, 0)) << "still rising";
}

TEST(Curve, FallsTowardsAPeakThatIsTheValueItBeganWith) {
  const Curve falling = {{1, 2, 3, 4}, {8, -6, 4, 2}};
  EXPECT_TRUE(falls_towards(falling, {0.5, 8.1}, false)) << "within the first sample";
  EXPECT_FALSE(falls_towards(falling, {0.5, 8.1}, true)) << "a blow within the first sample";
  EXPECT_TRUE(falls_towards(falling, {3, 4}, true)) << "its value at contact";
  EXPECT_FALSE(falls_towards(falling, {3, -7}, false)) << "higher than the sample before";
  EXPECT_FALSE(falls_towards({}, {1, 1}, false));
}

TEST(Curve, SlidesAMeanOverARectangularPulse) {
  // A pulse of height 4 and length 1 under a window of length 2. The mean is 2, up to the ramps of one
  // sample.
  const Curve c = sampled([](double t) { return t > 1 && t < 2 ? 4.0 : 0.0; }, 0, 5, 5000);
  EXPECT_NEAR(peak_of_mean(c, 2)->value, 2, 4e-3);
  EXPECT_NEAR(peak_of_mean(c, 0.5)->value, 4, 4e-3);
  EXPECT_FALSE(peak_of_mean(c, 6));
}

TEST(Curve, MeasuresTheRelativeL2DifferenceAcrossDifferentSamples) {
  const auto sine = [](double t) { return std::sin(t); };
  const Curve fine = sampled(sine, 0, 10, 10000), coarse = sampled(sine, -1, 12, 5003);
  EXPECT_LT(l2_difference(fine, coarse), 1e-5);
  EXPECT_NEAR(l2_difference(sampled([&](double t) { return 1.1 * sine(t); }, 0, 10, 10000), fine), 0.1, 1e-9);
}

TEST(Curve, FitsALineThroughNoiseThatIsEvenAboutIt) {
  Curve curve;
  for (int k = 0; k <= 400; ++k) {
    curve.time.push_back(0.01 * k);
    curve.value.push_back(3 * curve.time.back() - 7 +
                          0.5 * std::sin(10 * 3.141592653589793 * curve.time.back()));
  }
  // Over whole periods a sine has a slope of its own: −12 A/(ω L²), A its amplitude, L the length.
  EXPECT_NEAR(slope(curve, 0.2, 3.8), 3 - 12 * 0.5 / (10 * 3.141592653589793 * 3.6 * 3.6), 1e-3);
  EXPECT_NEAR(noise(curve, 0.2, 3.8), std::sqrt(0.125 + 9 * 3.6 * 3.6 / 12), 0.02);
  EXPECT_TRUE(std::isnan(slope({{1}, {1}}, 1, 1)));
  // A record that begins after `from` gives its own slope: nothing is known before it.
  EXPECT_NEAR(slope({{0.1, 0.2, 0.3}, {0.3, 0.6, 0.9}}, 0, 0.3), 3, 1e-12);
  const Deviation off = deviation(curve, {{1, 2}, {-4, 0}});
  EXPECT_NEAR(off.largest, 1, 1e-9);
  EXPECT_NEAR(off.mean, 0.5, 1e-9);
}

/// Numbers in (-1, 1) without a pattern.
double any_number() {
  static std::minstd_rand source(7);
  return 2 * static_cast<double>(source()) / static_cast<double>(std::minstd_rand::max()) - 1;
}

TEST(Curve, HasAFrequencyWhereAWaveStandsClear) {
  const auto curve_of = [](auto q) {
    Curve curve;
    for (int k = 0; k <= 1000; ++k) {
      curve.time.push_back(1e-3 * k);
      curve.value.push_back(q(curve.time.back()));
    }
    return curve;
  };
  const auto wave = [](double t) { return std::sin(2 * std::numbers::pi * 5 * t); };
  EXPECT_NEAR(*clear_frequency(curve_of([&](double t) { return std::exp(-2 * t) * wave(t) + 3; }), 0, 1), 5,
              0.1);
  EXPECT_NEAR(*clear_frequency(curve_of([&](double t) { return wave(t) + 0.2 * any_number(); }), 0, 1), 5,
              0.1);
  EXPECT_NEAR(*clear_frequency(curve_of([&](double t) { return std::pow(std::max(wave(t), 0.0), 4); }), 0, 1),
              5, 0.05)
      << "pulses";
  for (const double follows : {0.0, 0.5, 0.9, 0.97}) {  // noise, white and of lower and lower pitch
    double value = 0;
    const Curve noise = curve_of([&](double) { return value = follows * value + any_number(); });
    EXPECT_TRUE(period(noise, 0, 1)) << "noise has crossings";
    EXPECT_FALSE(clear_frequency(noise, 0, 1)) << follows;
  }
}

TEST(Curve, FindsThePeriodOfAWaveThroughItsNoise) {
  Curve curve;
  for (int k = 0; k <= 4000; ++k) {
    const double t = 1e-3 * k;
    curve.time.push_back(t);
    curve.value.push_back(0.5 + 0.03 * std::cos(2 * 3.141592653589793 * t / 0.8) +
                          (k % 2 == 0 ? 0.004 : -0.004));
  }
  // Noise of 0.004 moves a crossing by up to 0.004/(0.03 · 7.85/s) = 17 ms, of which four periods share two.
  EXPECT_NEAR(*period(curve, 0, 4), 0.8, 2 * 0.017 / 4);
  EXPECT_FALSE(period(curve, 0, 1));
}

TEST(Curve, FindsTheFrontOfAPlateau) {
  const Curve curve{{0, 0.6, 0.7, 0.8, 1.2}, {0, 0, 3000, 3600, 3600}};
  EXPECT_NEAR(*onset(curve, 0.8, 1.2), 0.66, 1e-12);  // 1800 of 3000 on the way from 0.6 s to 0.7 s
  EXPECT_EQ(*onset({{1, 2}, {1, 1}}, 1, 2), 1);
}

TEST(Curve, WarpsTimeSoThatAShiftCostsLittleAndAnotherShapeMuch) {
  const auto pulse = [](double at) { return [at](double t) { return std::exp(-20 * (t - at) * (t - at)); }; };
  const Curve here = sampled(pulse(1), 0, 4, 200), later = sampled(pulse(2), 0, 4, 200);
  EXPECT_EQ(time_warping(here, here), 0);
  EXPECT_GT(l2_difference(later, here), 1);
  EXPECT_LT(time_warping(later, here), 0.01);
  EXPECT_GT(time_warping(sampled([](double t) { return t / 4; }, 0, 4, 200), here), 0.1);
}

}  // namespace curve_test
}  // namespace strake
