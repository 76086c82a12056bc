#pragma once

#include <optional>
#include <vector>

namespace strake {

/// Samples of a quantity over time, times ascending; linear between samples, constant beyond the ends.
struct Curve {
  std::vector<double> time;  // [s]
  std::vector<double> value;
  std::size_t size() const { return time.size(); }
};

struct CurvePoint {
  double time = 0, value = 0;
};

double value_at(const Curve&, double time);
Curve resample(const Curve&, const std::vector<double>& times);
/// The part within [from, to], with interpolated end points.
Curve clip(const Curve&, double from, double to);
/// Largest |q|, with its sign; the first of equals. None for an empty curve.
std::optional<CurvePoint> peak(const Curve&);
/// First peak (cases/VALIDATION.md, "Definitions"). It is the running maximum M of |q| after `contact`, M >=
/// 5 % of the record's maximum, after which |q| falls below 0.8 M before exceeding M.
std::optional<CurvePoint> first_peak(const Curve&, double contact);
/// Whether a quantity falls towards its first peak, so that this is no peak but the value it began with. The
/// sample before it is larger, or there is none. A quantity that begins with contact rose within its first
/// sample.
bool falls_towards(const Curve&, const CurvePoint& first_peak, bool begins_with_contact);
double impulse(const Curve&, double from, double to);  // ∫ q dt, trapezoidal
/// ∫ q dt of a quantity whose values are means since the sample before, as those of a load are. What the
/// first sample tells of reaches back to `from`.
double impulse_of_means(const Curve&, double from, double to);
double mean(const Curve&, double from, double to);  // impulse / (to − from)
double rms(const Curve&, double from, double to);   // √((1/T) ∫ q² dt), exact for the linear interpolant
double noise(const Curve&, double from, double to);  // rms of q less its mean
/// Slope of the least-squares line through the samples within [from, to] and the interpolated ends, as far as
/// the record reaches. NaN for fewer than two.
double slope(const Curve&, double from, double to);
/// Mean time between upward crossings of the mean within [from, to]. A crossing is noise if the curve does
/// not reach half the rms about that mean on either side of it. None for fewer than two crossings.
std::optional<double> period(const Curve&, double from, double to);
/// 1 / `period` where a wave of it stands clear in the spectrum: over two periods it has 0.8 of the variance,
/// over more 0.55 of it. None else: noise has crossings too.
std::optional<double> clear_frequency(const Curve&, double from, double to);
/// Time from the curve's first sample at which |q| first reaches half of its mean over [from, to]. It marks
/// the front of a plateau. None if that never happens.
std::optional<double> onset(const Curve&, double from, double to);
/// (value − reference) / |reference|; the plain difference where the reference is 0.
double deviation(double value, double reference);
/// Deviation |a − b| at the samples of the reference b. It has a meaning only if a reaches as far as b.
struct Deviation {
  double largest = 0, mean = 0;
};
Deviation deviation(const Curve& a, const Curve& reference);
/// Largest |mean over `width`| of a window that slides from sample to sample, with its sign, at the window's
/// middle.
std::optional<CurvePoint> peak_of_mean(const Curve&, double width);
/// ‖a − b‖ / ‖b‖ over the common time span, b the reference, at the union of both sample times.
double l2_difference(const Curve&, const Curve& reference);
/// Dynamic time warping: the smallest sum of |a_i − b_j| over monotone pairings of samples. It is divided by
/// the number of pairs and by the largest |b|. Shifts in time do not change it, so that it separates a wrong
/// run from two noisy ones.
double time_warping(const Curve&, const Curve& reference);

}  // namespace strake
