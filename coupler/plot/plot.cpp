#include "coupler/plot/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace strake::report {
namespace {

Axis axis(double lo, double hi, bool logarithmic, const std::string& name, const std::string& unit) {
  Axis a;
  a.logarithmic = logarithmic;
  if (lo == hi) {
    const double room = lo == 0 ? 1 : 0.1 * std::abs(lo);
    lo -= room;
    hi += room;
  }
  a.lo = lo;
  a.hi = hi;
  a.prefix = prefix_for(std::max(std::abs(lo), std::abs(hi)), unit);
  const std::string with = with_prefix(a.prefix, unit);
  a.name = name + (with.empty() ? "" : " [" + with + "]");
  return a;
}

}  // namespace

double Axis::operator()(double value) const {
  const double s = logarithmic ? std::log(value / lo) / std::log(hi / lo) : (value - lo) / (hi - lo);
  return from + s * (to - from);
}

std::vector<std::pair<double, std::string>> Axis::ticks(int wanted) const {
  std::vector<std::pair<double, std::string>> marks;
  // Marks of a logarithmic axis are powers of ten. If these are too few, they are also 2 and 5 times those.
  // Over a smaller range they are round numbers as on a linear axis.
  for (const auto& steps : {std::vector<double>{1}, std::vector<double>{1, 2, 5}}) {
    if (!logarithmic || marks.size() > 2) break;
    marks.clear();
    for (double power = std::pow(10, std::floor(std::log10(lo))); power <= hi; power *= 10)
      for (const double m : steps)
        if (m * power >= lo * (1 - 1e-9) && m * power <= hi * (1 + 1e-9))
          marks.emplace_back(m * power, fmt::format("{:.3g}", prefix.factor * m * power));
  }
  if (marks.size() > 2) return marks;
  marks = text_ticks(prefix.factor * lo, prefix.factor * hi, wanted);
  for (auto& [value, text] : marks) value /= prefix.factor;
  return marks;
}

std::optional<Axes> axes_of(const Plot& plot, const Box& box) {
  const bool log = plot.logarithmic;
  double x_lo = 1e300, x_hi = -1e300, y_lo = 1e300, y_hi = -1e300;
  for (const Series& series : plot.series)
    for (std::size_t k = 0; k < series.curve.size(); ++k) {
      const double x = series.curve.time[k], y = series.curve.value[k];
      if (!usable(x, log) || !usable(y, log)) continue;
      if (plot.window && (x < plot.window->first || x > plot.window->second)) continue;
      x_lo = std::min(x_lo, x);
      x_hi = std::max(x_hi, x);
      y_lo = std::min(y_lo, y);
      y_hi = std::max(y_hi, y);
    }
  if (!(x_lo <= x_hi)) return std::nullopt;
  for (const ReferenceLine& line : plot.references)
    if (usable(line.value, log)) {
      y_lo = std::min(y_lo, line.value - line.within);
      y_hi = std::max(y_hi, line.value + line.within);
    }
  if (plot.window) std::tie(x_lo, x_hi) = *plot.window;
  for (const Series& series : plot.series)
    if (series.marker && series.marker->time >= x_lo && series.marker->time <= x_hi) {
      y_lo = std::min(y_lo, series.marker->value);
      y_hi = std::max(y_hi, series.marker->value);
    }
  const double room = 0.05 * (y_hi - y_lo), factor = log ? std::pow(y_hi / y_lo, 0.08) : 1;
  Axes axes = {axis(log ? x_lo / 1.15 : x_lo, log ? x_hi * 1.15 : x_hi, log, plot.x_name, plot.x_unit),
               axis(log ? y_lo / factor : y_lo - room, log ? y_hi * factor : y_hi + room, log, plot.y_name,
                    plot.y_unit)};
  axes.x.from = box.left;
  axes.x.to = box.right;
  axes.y.from = box.bottom;
  axes.y.to = box.top;
  return axes;
}

bool usable(double value, bool logarithmic) {
  return std::isfinite(value) && (!logarithmic || value > 0);
}

Curve inside(const Curve& curve, double lo, double hi) {
  Curve part;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    const bool before = k + 1 < curve.size() && curve.time[k + 1] < lo;
    const bool after = k > 0 && curve.time[k - 1] > hi;
    if (before || after) continue;
    part.time.push_back(curve.time[k]);
    part.value.push_back(curve.value[k]);
  }
  return part;
}

Curve thinned(const Curve& curve, const Axis& x) {
  if (curve.size() < 4 * static_cast<std::size_t>(std::abs(x.to - x.from))) return curve;
  Curve thin;
  const auto take = [&](std::size_t k) {
    if (!thin.time.empty() && curve.time[k] == thin.time.back()) return;
    thin.time.push_back(curve.time[k]);
    thin.value.push_back(curve.value[k]);
  };
  for (std::size_t begin = 0; begin < curve.size();) {
    const double column = std::floor(x(curve.time[begin]));
    std::size_t end = begin, least = begin, most = begin;
    for (; end < curve.size() && std::floor(x(curve.time[end])) == column; ++end) {
      if (curve.value[end] < curve.value[least]) least = end;
      if (curve.value[end] > curve.value[most]) most = end;
    }
    take(begin);
    take(std::min(least, most));
    take(std::max(least, most));
    take(end - 1);
    begin = end;
  }
  return thin;
}

bool lonely(const Curve& curve, std::size_t sample, bool logarithmic) {
  const auto there = [&](std::size_t k) {
    return k < curve.size() && usable(curve.time[k], logarithmic) && usable(curve.value[k], logarithmic);
  };
  return there(sample) && !there(sample + 1) && (sample == 0 || !there(sample - 1));
}

}  // namespace strake::report
