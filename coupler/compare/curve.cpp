#include "coupler/compare/curve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace strake {

double value_at(const Curve& c, double time) {
  assert(c.size() > 0);
  const auto after = std::upper_bound(c.time.begin(), c.time.end(), time);
  if (after == c.time.begin()) return c.value.front();
  if (after == c.time.end()) return c.value.back();
  const auto k = static_cast<std::size_t>(after - c.time.begin());
  const double s = (time - c.time[k - 1]) / (c.time[k] - c.time[k - 1]);
  return (1 - s) * c.value[k - 1] + s * c.value[k];
}

Curve resample(const Curve& c, const std::vector<double>& times) {
  Curve result = {times, {}};
  for (const double t : times) result.value.push_back(value_at(c, t));
  return result;
}

Curve clip(const Curve& c, double from, double to) {
  if (c.size() == 0 || to < from) return {};
  std::vector<double> times = {from};
  for (const double t : c.time)
    if (t > from && t < to) times.push_back(t);
  if (to > from) times.push_back(to);
  return resample(c, times);
}

std::optional<CurvePoint> peak(const Curve& c) {
  std::optional<CurvePoint> best;
  for (std::size_t k = 0; k < c.size(); ++k)
    if (!best || std::abs(c.value[k]) > std::abs(best->value)) best = {c.time[k], c.value[k]};
  return best;
}

std::optional<CurvePoint> first_peak(const Curve& c, double contact) {
  constexpr double of_record = 0.05, fallen = 0.8;  // cases/VALIDATION.md, "Definitions"
  const auto largest = peak(c);
  if (!largest) return std::nullopt;
  CurvePoint running;
  for (std::size_t k = 0; k < c.size(); ++k) {
    if (c.time[k] < contact) continue;
    const double q = std::abs(c.value[k]), m = std::abs(running.value);
    if (q > m)
      running = {c.time[k], c.value[k]};
    else if (q < fallen * m && m >= of_record * std::abs(largest->value))
      return running;
  }
  return std::nullopt;
}

bool falls_towards(const Curve& c, const CurvePoint& first_peak, bool begins_with_contact) {
  if (c.size() == 0) return false;
  const auto after = std::lower_bound(c.time.begin(), c.time.end(), first_peak.time) - c.time.begin();
  if (after == 0) return !begins_with_contact;
  return std::abs(c.value[static_cast<std::size_t>(after - 1)]) > std::abs(first_peak.value);
}

double impulse_of_means(const Curve& c, double from, double to) {
  double sum = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double begin = k > 0 ? c.time[k - 1] : from;
    const double overlap = std::min(to, c.time[k]) - std::max(from, begin);
    if (overlap > 0) sum += overlap * c.value[k];
  }
  return sum;
}

double impulse(const Curve& c, double from, double to) {
  const Curve part = clip(c, from, to);
  double sum = 0;
  for (std::size_t k = 1; k < part.size(); ++k)
    sum += 0.5 * (part.time[k] - part.time[k - 1]) * (part.value[k] + part.value[k - 1]);
  return sum;
}

double mean(const Curve& c, double from, double to) {
  return to > from ? impulse(c, from, to) / (to - from) : value_at(c, from);
}

double rms(const Curve& c, double from, double to) {
  if (!(to > from)) return std::abs(value_at(c, from));
  const Curve part = clip(c, from, to);
  double sum = 0;
  // ∫ of the square of a linear function over an interval: (a² + ab + b²)/3
  for (std::size_t k = 1; k < part.size(); ++k) {
    const double a = part.value[k - 1], b = part.value[k];
    sum += (part.time[k] - part.time[k - 1]) * (a * a + a * b + b * b) / 3;
  }
  return std::sqrt(sum / (to - from));
}

double noise(const Curve& c, double from, double to) {
  const double middle = mean(c, from, to);
  Curve rest = c;
  for (double& q : rest.value) q -= middle;
  return rms(rest, from, to);
}

// Σ (t − t̄)(q − q̄) / Σ (t − t̄)²
double slope(const Curve& c, double from, double to) {
  if (c.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const Curve part = clip(c, std::max(from, c.time.front()), std::min(to, c.time.back()));
  const auto n = static_cast<double>(part.size());
  double t_sum = 0, q_sum = 0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    t_sum += part.time[k];
    q_sum += part.value[k];
  }
  double with = 0, square = 0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double t = part.time[k] - t_sum / n;
    with += t * (part.value[k] - q_sum / n);
    square += t * t;
  }
  return square > 0 ? with / square : std::numeric_limits<double>::quiet_NaN();
}

namespace {

/// Times of the upward crossings of the mean that are no noise.
std::vector<double> rises(const Curve& c, double from, double to) {
  const double middle = mean(c, from, to), half = 0.5 * noise(c, from, to);
  const Curve part = clip(c, from, to);
  std::vector<double> times;
  std::optional<double> crossing;
  bool low = false;  // has been below the band since the last rise
  for (std::size_t k = 0; k < part.size(); ++k) {
    const double q = part.value[k] - middle, before = k > 0 ? part.value[k - 1] - middle : q;
    if (q <= -half) low = true;
    if (before < 0 && q >= 0)
      crossing = part.time[k - 1] + before / (before - q) * (part.time[k] - part.time[k - 1]);
    if (!low || q < half || !crossing) continue;
    low = false;
    times.push_back(*crossing);
  }
  return times;
}

/// ∫ q(t) w(2πft) dt over the whole curve.
double transform(const Curve& c, double frequency, double (*wave)(double)) {
  Curve product = c;
  for (std::size_t k = 0; k < c.size(); ++k)
    product.value[k] *= wave(2 * std::numbers::pi * frequency * c.time[k]);
  return impulse(product, c.time.front(), c.time.back());
}

}  // namespace

std::optional<double> period(const Curve& c, double from, double to) {
  const std::vector<double> times = rises(c, from, to);
  if (times.size() < 2) return std::nullopt;
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

// Over n whole periods T of the curve q about its mean, the wave of frequency f = n/T has the part
//   P = 2/T² ((∫ q cos 2πft dt)² + (∫ q sin 2πft dt)²)  of the variance  V = 1/T ∫ q² dt.
std::optional<double> clear_frequency(const Curve& c, double from, double to) {
  // Measured on 400 records of each kind of noise: at most 7 % pass these bounds where the spectrum falls
  // with slope 1, 2 or 4 above 2 to 60 periods per record. Of random walks 1 % pass, of white noise none.
  // With 0.7 and 0.5 at most 12 % pass; 0.6 would refuse pulses sin^4, whose share is 0.57.
  // Sines, decays of up to 10 % of the critical damping and sines with noise of a tenth have 0.78 to 1.
  // One period alone is no sign: there the median share of such noise is 0.5 to 0.99.
  constexpr double needed_of_two = 0.8, needed = 0.55;
  const std::vector<double> times = rises(c, from, to);
  if (times.size() < 3) return std::nullopt;
  Curve part = clip(c, times.front(), times.back());
  const double length = times.back() - times.front(), middle = mean(part, times.front(), times.back()),
               variance = std::pow(noise(part, times.front(), times.back()), 2),
               frequency = static_cast<double>(times.size() - 1) / length;
  for (double& q : part.value) q -= middle;
  const double with_cos = transform(part, frequency, [](double x) { return std::cos(x); }),
               with_sin = transform(part, frequency, [](double x) { return std::sin(x); });
  const double share = 2 * (with_cos * with_cos + with_sin * with_sin) / (length * length * variance);
  if (!(share >= (times.size() == 3 ? needed_of_two : needed))) return std::nullopt;
  return frequency;
}

std::optional<double> onset(const Curve& c, double from, double to) {
  Curve size = c;
  for (double& q : size.value) q = std::abs(q);
  const double wanted = 0.5 * mean(size, from, to);
  for (std::size_t k = 0; k < size.size(); ++k) {
    if (size.value[k] < wanted) continue;
    if (k == 0) return size.time[0];
    const double before = size.value[k - 1], share = (wanted - before) / (size.value[k] - before);
    return size.time[k - 1] + share * (size.time[k] - size.time[k - 1]);
  }
  return std::nullopt;
}

double deviation(double value, double reference) {
  return reference == 0 ? value : (value - reference) / std::abs(reference);
}

Deviation deviation(const Curve& a, const Curve& reference) {
  if (a.size() == 0 || reference.size() == 0)
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  Deviation result;
  for (std::size_t k = 0; k < reference.size(); ++k) {
    const double off = std::abs(value_at(a, reference.time[k]) - reference.value[k]);
    result.largest = std::max(result.largest, off);
    result.mean += off / static_cast<double>(reference.size());
  }
  return result;
}

std::optional<CurvePoint> peak_of_mean(const Curve& c, double width) {
  if (c.size() == 0 || c.time.back() - c.time.front() < width) return std::nullopt;
  // Running integral at the samples, and between them by the trapezoidal rule.
  std::vector<double> integral = {0};
  for (std::size_t k = 1; k < c.size(); ++k)
    integral.push_back(integral.back() + 0.5 * (c.time[k] - c.time[k - 1]) * (c.value[k] + c.value[k - 1]));
  std::optional<CurvePoint> best;
  std::size_t left = 0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double from = c.time[k] - width;
    if (from < c.time.front()) continue;
    while (left + 1 < c.size() && c.time[left + 1] <= from) ++left;
    const double before = integral[left] + 0.5 * (from - c.time[left]) * (c.value[left] + value_at(c, from));
    const double m = (integral[k] - before) / width;
    if (!best || std::abs(m) > std::abs(best->value)) best = {c.time[k] - 0.5 * width, m};
  }
  return best;
}

double l2_difference(const Curve& a, const Curve& b) {
  if (a.size() == 0 || b.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const double from = std::max(a.time.front(), b.time.front()), to = std::min(a.time.back(), b.time.back());
  if (!(to > from)) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> times = {from, to};
  for (const auto* c : {&a, &b})
    for (const double t : c->time)
      if (t > from && t < to) times.push_back(t);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  Curve difference = resample(a, times);
  const Curve reference = resample(b, times);
  for (std::size_t k = 0; k < times.size(); ++k) difference.value[k] -= reference.value[k];
  return rms(difference, from, to) / rms(reference, from, to);
}

double time_warping(const Curve& a, const Curve& b) {
  if (a.size() == 0 || b.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  // cost(i, j) = |a_i − b_j| + min(cost(i−1, j−1), cost(i−1, j), cost(i, j−1)); `pairs` counts along that
  // path.
  struct Cell {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t pairs = 0;
  };
  std::vector<Cell> previous(b.size() + 1), row(b.size() + 1);
  previous[0].cost = 0;
  for (const double q : a.value) {
    row[0] = {};
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const Cell* from = &previous[j - 1];
      if (previous[j].cost < from->cost) from = &previous[j];
      if (row[j - 1].cost < from->cost) from = &row[j - 1];
      row[j] = {from->cost + std::abs(q - b.value[j - 1]), from->pairs + 1};
    }
    std::swap(previous, row);
  }
  const double scale = std::abs(peak(b)->value);
  return previous.back().cost / static_cast<double>(previous.back().pairs) / scale;
}

}  // namespace strake
