#include "coupler/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "coupler/picture/ticks.hpp"
#include "coupler/report/html.hpp"

namespace strake::report {
namespace {

constexpr double width = 480, height = 300, right = 14, top = 14, bottom = 46;
constexpr int styles = 8;  // that the page's style sheet knows

/// One direction of a plot: from values to pixels, with its ticks.
struct Axis {
  double lo = 0, hi = 1, from = 0, to = 1;
  bool logarithmic = false;
  Prefix prefix;
  std::string name;

  double operator()(double value) const {
    const double s = logarithmic ? std::log(value / lo) / std::log(hi / lo) : (value - lo) / (hi - lo);
    return from + s * (to - from);
  }
  std::vector<std::pair<double, std::string>> ticks(int wanted) const {
    std::vector<std::pair<double, std::string>> marks;
    // Powers of ten where there are enough of them, else 1, 2 and 5 times those; over less than that, round
    // numbers as on a straight axis.
    for (const auto& steps : {std::vector<double>{1}, std::vector<double>{1, 2, 5}}) {
      if (!logarithmic || marks.size() > 2) break;
      marks.clear();
      for (double power = std::pow(10, std::floor(std::log10(lo))); power <= hi; power *= 10)
        for (const double m : steps)
          if (m * power >= lo * (1 - 1e-9) && m * power <= hi * (1 + 1e-9))
            marks.emplace_back(m * power, fmt::format("{:.3g}", prefix.factor * m * power));
    }
    if (marks.size() > 2) return marks;
    marks.clear();
    const auto round = round_ticks(prefix.factor * lo, prefix.factor * hi, wanted);
    for (const double t : round)
      marks.emplace_back(t / prefix.factor, tick_text(t, round.size() > 1 ? round[1] - round[0] : 0));
    return marks;
  }
};

bool usable(double value, bool logarithmic) {
  return std::isfinite(value) && (!logarithmic || value > 0);
}

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

/// The samples inside the window, and one on either side so that the line runs to the edge.
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

/// Of many samples the first, last, least and largest of each pixel column: the drawn line is the same.
Curve thinned(const Curve& curve, const Axis& x) {
  if (curve.size() < 4 * static_cast<std::size_t>(width)) return curve;
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

std::string path(const Curve& curve, const Axis& x, const Axis& y, bool logarithmic) {
  std::string d;
  bool pen_down = false;
  for (std::size_t k = 0; k < curve.size(); ++k) {
    if (!usable(curve.time[k], logarithmic) || !usable(curve.value[k], logarithmic)) {
      pen_down = false;
      continue;
    }
    fmt::format_to(std::back_inserter(d), "{}{:.1f} {:.1f}", pen_down ? "L" : "M", x(curve.time[k]),
                   y(curve.value[k]));
    pen_down = true;
  }
  return d;
}

void draw_axes(std::string& svg, const Axis& x, const Axis& y) {
  for (const auto& [value, text] : x.ticks(6)) {
    const double at = x(value);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4}"
        "</text>\n",
        at, top, height - bottom, height - bottom + 18, text);
  }
  for (const auto& [value, text] : y.ticks(6)) {
    const double at = y(value);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{0} {1:.1f}H{2}\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}"
        "</text>\n",
        x.from, at, width - right, x.from - 6, at + 4.5, text);
  }
  svg +=
      fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>\n", x.from, top, height - bottom, width - right);
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     0.5 * (x.from + width - right), height - 8, escape(x.name));
  svg +=
      fmt::format("<text transform=\"translate(15 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                  0.5 * (top + height - bottom), escape(y.name));
}

std::string swatch(const std::string& kind) {
  return fmt::format(
      "<svg class=\"swatch\" viewBox=\"0 0 30 12\" aria-hidden=\"true\"><path class=\"{}\" d=\"M1 "
      "6H29\"/></svg>",
      kind);
}

std::string legend(const Plot& plot) {
  std::string text = "<ul class=\"legend\">";
  for (const Series& series : plot.series)
    text += fmt::format("<li>{}{}</li>", swatch(fmt::format("line s{}", series.style % styles)),
                        escape(series.name));
  for (const ReferenceLine& line : plot.references)
    text += fmt::format("<li>{}{}: {}</li>", swatch("reference"), escape(line.name),
                        escape(quantity(line.value, plot.y_unit)));
  const bool marked = std::any_of(plot.series.begin(), plot.series.end(),
                                  [](const Series& s) { return s.marker.has_value(); });
  if (marked)
    text +=
        "<li><svg class=\"swatch\" viewBox=\"0 0 30 12\" aria-hidden=\"true\"><circle class=\"ring\" "
        "cx=\"15\" cy=\"6\" r=\"4\"/></svg>first peak</li>";
  return text + "</ul>";
}

}  // namespace

std::string figure(const Plot& plot) {
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
  if (!(x_lo <= x_hi)) return {};
  for (const ReferenceLine& line : plot.references)
    if (usable(line.value, log)) {
      y_lo = std::min(y_lo, line.value);
      y_hi = std::max(y_hi, line.value);
    }
  if (plot.window) std::tie(x_lo, x_hi) = *plot.window;
  for (const Series& series : plot.series)
    if (series.marker && series.marker->time >= x_lo && series.marker->time <= x_hi) {
      y_lo = std::min(y_lo, series.marker->value);
      y_hi = std::max(y_hi, series.marker->value);
    }
  const double room = 0.05 * (y_hi - y_lo), factor = log ? std::pow(y_hi / y_lo, 0.08) : 1;
  Axis x = axis(log ? x_lo / 1.15 : x_lo, log ? x_hi * 1.15 : x_hi, log, plot.x_name, plot.x_unit);
  Axis y = axis(log ? y_lo / factor : y_lo - room, log ? y_hi * factor : y_hi + room, log, plot.y_name,
                plot.y_unit);
  y.from = height - bottom;
  y.to = top;
  std::size_t longest = 0;  // tick, in letters
  for (const auto& [value, text] : y.ticks(6)) longest = std::max(longest, text.size());
  const double left = std::max(58.0, 32 + 8.5 * static_cast<double>(longest));
  x.from = left;
  x.to = width - right;

  std::string svg = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {0} {1}\" role=\"img\" aria-label=\"{2}\">\n<title>{2}</title>\n",
      width, height, escape(plot.title));
  draw_axes(svg, x, y);
  // An inner svg shows nothing outside its box.
  svg += fmt::format("<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">\n",
                     left, top, width - left - right, height - top - bottom);
  for (const ReferenceLine& line : plot.references)
    if (usable(line.value, log))
      svg += fmt::format("<path class=\"reference\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n",
                         line.over ? x(line.over->first) : left, y(line.value),
                         line.over ? x(line.over->second) : width - right);
  for (const Series& series : plot.series) {
    const Curve shown = thinned(inside(series.curve, x.lo, x.hi), x);
    svg += fmt::format("<path class=\"line s{}\" d=\"{}\"><title>{}</title></path>\n", series.style % styles,
                       path(shown, x, y, log), escape(series.name));
    if (series.dots)
      for (std::size_t k = 0; k < shown.size(); ++k)
        if (usable(shown.time[k], log) && usable(shown.value[k], log))
          svg += fmt::format("<circle class=\"dot s{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>\n",
                             series.style % styles, x(shown.time[k]), y(shown.value[k]));
  }
  svg += "</svg>\n";
  for (const Series& series : plot.series)
    if (series.marker && series.marker->time >= x.lo && series.marker->time <= x.hi &&
        usable(series.marker->value, log))
      svg += fmt::format("<circle class=\"ring s{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\"/>\n",
                         series.style % styles, x(series.marker->time), y(series.marker->value));
  svg += "</svg>";
  return fmt::format(
      "<figure>\n<div class=\"scroll\">"
      "{1}</div>\n<figcaption><strong>{0}</strong>{2}</figcaption>\n</figure>\n",
      escape(plot.title), svg, legend(plot));
}

}  // namespace strake::report
