#include "coupler/plot/plot.hpp"

#include "coupler/plot/html.hpp"
#include "coupler/plot/plot_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace strake::report {
namespace {

constexpr double width = 480, height = 300, right = 14, top = 14, bottom = 46;
constexpr int styles = 8;  // that the page's style sheet defines

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
  const auto made = axes_of(plot, {.left = 0, .right = width - right, .top = top, .bottom = height - bottom});
  if (!made) return {};
  auto [x, y] = *made;
  const bool log = plot.logarithmic;
  std::size_t longest = 0;  // tick, in letters
  for (const auto& [value, text] : y.ticks(6)) longest = std::max(longest, text.size());
  const double left = std::max(58.0, 32 + 8.5 * static_cast<double>(longest));
  x.from = left;

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
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const bool there = usable(shown.time[k], log) && usable(shown.value[k], log);
      if ((series.dots && there) || lonely(shown, k, log))
        svg += fmt::format("<circle class=\"dot s{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>\n",
                           series.style % styles, x(shown.time[k]), y(shown.value[k]));
    }
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
