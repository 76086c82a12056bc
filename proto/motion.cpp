#include "proto/motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace strake {
namespace {

double secant(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
  return (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
}

/// ∫_0^θ of the cubic Hermite piece, in units of the piece's length: value a to b, slopes·length da and db.
double integral_of_piece(double a, double b, double da, double db, double s) {
  const double s2 = s * s, s3 = s2 * s, s4 = s3 * s;
  return a * (s - s3 + 0.5 * s4) + da * (0.5 * s2 - 2 * s3 / 3 + 0.25 * s4) + b * (s3 - 0.5 * s4) +
         db * (0.25 * s4 - s3 / 3);
}

/// One-sided three-point slope at an end, kept monotone: h0, h1 the pieces from the end, d0, d1 their
/// secants.
double end_slope(double h0, double h1, double d0, double d1) {
  const double s = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (s * d0 <= 0) return 0;
  return d0 * d1 <= 0 && std::abs(s) > 3 * std::abs(d0) ? 3 * d0 : s;
}

}  // namespace

// Continuity of the second derivative at knot i, pieces h_i = x_{i+1} − x_i with secants δ_i:
//   h_i s_{i−1} + 2 (h_{i−1} + h_i) s_i + h_{i−1} s_{i+1} = 3 (h_i δ_{i−1} + h_{i−1} δ_i)
// and of the third at the second and the last but one, from which s_2 (s_{n−3}) is eliminated.
std::vector<double> spline_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  assert(n >= 2 && y.size() == n);
  if (n == 2) return {secant(x, y, 0), secant(x, y, 0)};
  const auto h = [&](std::size_t i) { return x[i + 1] - x[i]; };
  if (n == 3) {
    const double d0 = secant(x, y, 0), d1 = secant(x, y, 1), curve = (d1 - d0) / (x[2] - x[0]);
    return {d0 - curve * h(0), d0 + curve * h(0), d1 + curve * h(1)};
  }
  std::vector<double> below(n), diagonal(n), above(n), right(n);
  const auto end = [&](double h0, double h1, double d0, double d1) {
    return ((h0 + 2 * (h0 + h1)) * h1 * d0 + h0 * h0 * d1) / (h0 + h1);
  };
  diagonal[0] = h(1);
  above[0] = h(0) + h(1);
  right[0] = end(h(0), h(1), secant(x, y, 0), secant(x, y, 1));
  for (std::size_t i = 1; i + 1 < n; ++i) {
    below[i] = h(i);
    diagonal[i] = 2 * (h(i - 1) + h(i));
    above[i] = h(i - 1);
    right[i] = 3 * (h(i) * secant(x, y, i - 1) + h(i - 1) * secant(x, y, i));
  }
  diagonal[n - 1] = h(n - 3);
  below[n - 1] = h(n - 2) + h(n - 3);
  right[n - 1] = end(h(n - 2), h(n - 3), secant(x, y, n - 2), secant(x, y, n - 3));
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = below[i] / diagonal[i - 1];
    diagonal[i] -= factor * above[i - 1];
    right[i] -= factor * right[i - 1];
  }
  std::vector<double> slope(n);
  slope[n - 1] = right[n - 1] / diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) slope[i] = (right[i] - above[i] * slope[i + 1]) / diagonal[i];
  return slope;
}

// Fritsch & Carlson's condition by the weighted harmonic mean of the two secants; zero at an extremum.
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  assert(n >= 2 && y.size() == n);
  if (n == 2) return {secant(x, y, 0), secant(x, y, 0)};
  std::vector<double> slope(n, 0.0);
  const auto h = [&](std::size_t i) { return x[i + 1] - x[i]; };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = secant(x, y, i - 1), after = secant(x, y, i);
    if (before * after <= 0) continue;
    const double a = 2 * h(i) + h(i - 1), b = h(i) + 2 * h(i - 1);
    slope[i] = (a + b) / (a / before + b / after);
  }
  slope[0] = end_slope(h(0), h(1), secant(x, y, 0), secant(x, y, 1));
  slope[n - 1] = end_slope(h(n - 2), h(n - 3), secant(x, y, n - 2), secant(x, y, n - 3));
  return slope;
}

MotionTable::MotionTable(std::vector<double> time, std::array<MotionColumn, n_channels> kind,
                         std::array<std::vector<double>, n_channels> value)
    : time_(std::move(time)) {
  assert(time_.size() >= 2 && std::is_sorted(time_.begin(), time_.end(), std::less_equal<>()));
  for (std::size_t c = 0; c < n_channels; ++c) {
    Channel& channel = channel_[c];
    channel.kind = kind[c];
    if (kind[c] == MotionColumn::absent) continue;
    assert(value[c].size() == time_.size());
    channel.value = std::move(value[c]);
    if (kind[c] == MotionColumn::place) {
      channel.slope = spline_slopes(time_, channel.value);
      continue;
    }
    channel.slope = monotone_slopes(time_, channel.value);
    channel.integral.assign(1, 0.0);
    for (std::size_t i = 0; i + 1 < time_.size(); ++i) {
      const double h = time_[i + 1] - time_[i];
      channel.integral.push_back(channel.integral.back() +
                                 h * integral_of_piece(channel.value[i], channel.value[i + 1],
                                                       h * channel.slope[i], h * channel.slope[i + 1], 1));
    }
  }
}

MotionTable::Jet MotionTable::evaluate(const Channel& channel, double t) const {
  if (channel.kind == MotionColumn::absent) return {};
  const bool is_rate = channel.kind == MotionColumn::rate;
  if (t < time_.front() || t > time_.back()) {
    const std::size_t k = t < time_.front() ? 0 : time_.size() - 1;
    const double rate = is_rate ? channel.value[k] : channel.slope[k];
    return {(is_rate ? channel.integral[k] : channel.value[k]) + rate * (t - time_[k]), rate, 0};
  }
  const auto after = std::upper_bound(time_.begin() + 1, time_.end() - 1, t);
  const auto i = static_cast<std::size_t>(after - time_.begin()) - 1;
  const double h = time_[i + 1] - time_[i], s = (t - time_[i]) / h;
  const double a = channel.value[i], b = channel.value[i + 1];
  const double da = h * channel.slope[i], db = h * channel.slope[i + 1];
  const double rise = b - a;  // the piece is a + da s + (3 rise − 2 da − db) s² + (da + db − 2 rise) s³
  const double second = 3 * rise - 2 * da - db, third = da + db - 2 * rise;
  const double value = a + s * (da + s * (second + s * third));
  const double first_derivative = (da + s * (2 * second + 3 * s * third)) / h;
  if (is_rate) return {channel.integral[i] + h * integral_of_piece(a, b, da, db, s), value, first_derivative};
  return {value, first_derivative, (2 * second + 6 * s * third) / (h * h)};
}

double MotionTable::largest_speed(double until, double reach) const {
  const auto speed = [&](double t) {
    const RigidMotion motion = at(t);
    return motion.velocity.norm() + std::abs(motion.angular_velocity) * reach;
  };
  double largest = std::max(speed(0), speed(until));
  const auto look = [&](double t) {
    if (t > 0 && t < until) largest = std::max(largest, speed(t));
  };
  for (std::size_t k = 0; k < time_.size(); ++k) {
    look(time_[k]);
    if (k > 0) look(0.5 * (time_[k - 1] + time_[k]));
  }
  return largest;
}

RigidMotion MotionTable::at(double t) const {
  RigidMotion motion;
  for (std::size_t c = 0; c < 3; ++c) {
    const Jet jet = evaluate(channel_[c], t);
    const auto axis = static_cast<Eigen::Index>(c);
    motion.displacement[axis] = jet.place;
    motion.velocity[axis] = jet.rate;
    motion.acceleration[axis] = jet.change;
  }
  const Jet turn = evaluate(channel_[3], t);
  motion.angle = turn.place;
  motion.angular_velocity = turn.rate;
  motion.angular_acceleration = turn.change;
  return motion;
}

}  // namespace strake
