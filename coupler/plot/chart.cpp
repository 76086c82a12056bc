#include "coupler/plot/chart.hpp"

#include "coupler/plot/html.hpp"
#include "coupler/plot/plot_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace strake::picture {
namespace {

using report::Axes;
using report::Box;
using report::Plot;
using report::ReferenceLine;
using report::Series;

constexpr double small = 13, large = 16;                              // [px] letters
constexpr double edge = 18, title_height = 34, row = 22, below = 52;  // [px]
constexpr double line_width = 2, swatch = 34;                         // [px]
const Colour ink = {0.11, 0.13, 0.16}, grid = {0.90, 0.92, 0.93}, frame = {0.31, 0.35, 0.40},
             band = {0.93, 0.94, 0.88};

/// The report's styles: colours of equal weight, and dashes for readers who cannot distinguish them.
struct Look {
  Colour colour;
  std::vector<double> dashes;
};
const std::array<Look, 8>& looks() {
  static const std::array<Look, 8> known = {{{{0.043, 0.384, 0.769}, {}},
                                             {{0.761, 0.255, 0.047}, {9, 3}},
                                             {{0.067, 0.451, 0.294}, {4, 2}},
                                             {{0.545, 0.184, 0.690}, {10, 3, 2, 3}},
                                             {{0.541, 0.353, 0.000}, {6, 2, 1, 2}},
                                             {{0.055, 0.455, 0.565}, {14, 3}},
                                             {{0.706, 0.137, 0.373}, {3, 3}},
                                             {{0.341, 0.376, 0.416}, {8, 2, 3, 2}}}};
  return known;
}
const Look& look_of(const Series& series) {
  return looks()[static_cast<std::size_t>(series.style) % looks().size()];
}
const std::vector<double> dotted = {2, 4};

/// One entry of the legend and how its sign is drawn.
struct Entry {
  std::string text;
  const Series* series = nullptr;
  const ReferenceLine* reference = nullptr;
  bool ring = false;
};

std::vector<Entry> entries_of(const Plot& plot) {
  std::vector<Entry> entries;
  for (const Series& series : plot.series) entries.push_back({.text = series.name, .series = &series});
  for (const ReferenceLine& line : plot.references) {
    std::string text = line.name + ": " + report::quantity(line.value, plot.y_unit);
    if (line.within > 0)
      text += " ± " + (line.value == 0 ? report::quantity(line.within, plot.y_unit)
                                       : fmt::format("{:.3g} %", 100 * line.within / std::abs(line.value)));
    entries.push_back({.text = text, .reference = &line});
  }
  if (std::any_of(plot.series.begin(), plot.series.end(),
                  [](const Series& s) { return s.marker.has_value(); }))
    entries.push_back({.text = "first peak", .ring = true});
  return entries;
}

/// The entries in lines that are not wider than the picture.
std::vector<std::vector<Entry>> in_rows(Canvas& canvas, const std::vector<Entry>& entries, double width) {
  std::vector<std::vector<Entry>> rows;
  double taken = width;
  for (const Entry& entry : entries) {
    const double own = swatch + canvas.text_width(entry.text, small) + 30;
    if (rows.empty() || taken + own > width) {
      rows.emplace_back();
      taken = 0;
    }
    rows.back().push_back(entry);
    taken += own;
  }
  return rows;
}

void draw_legend(Canvas& canvas, const std::vector<std::vector<Entry>>& rows, double x0, double y) {
  for (const auto& entries : rows) {
    double x = x0;
    for (const Entry& entry : entries) {
      const double middle = y - 4;
      if (entry.series != nullptr) {
        const Look& look = look_of(*entry.series);
        if (entry.series->dots)
          canvas.ring(x + 13, middle, 4, line_width, look.colour);
        else
          canvas.curve({{x, middle}, {x + 26, middle}}, line_width, look.colour, look.dashes);
      } else if (entry.reference != nullptr) {
        if (entry.reference->within > 0) canvas.fill_rectangle(x, middle - 6, 26, 12, band);
        canvas.curve({{x, middle}, {x + 26, middle}}, 1.5, ink, dotted);
      } else {
        canvas.ring(x + 13, middle, 5, line_width, ink);
      }
      canvas.text(x + swatch, y, entry.text, small);
      x += swatch + canvas.text_width(entry.text, small) + 30;
    }
    y += row;
  }
}

void draw_axes(Canvas& canvas, const Axes& axes, const Box& box) {
  for (const auto& [value, text] : axes.x.ticks(8)) {
    const double at = axes.x(value);
    canvas.curve({{at, box.top}, {at, box.bottom}}, 1, grid);
    canvas.text(at, box.bottom + 19, text, small, Canvas::Align::centre);
  }
  for (const auto& [value, text] : axes.y.ticks(6)) {
    const double at = axes.y(value);
    canvas.curve({{box.left, at}, {box.right, at}}, 1, grid);
    canvas.text(box.left - 7, at + 4.5, text, small, Canvas::Align::right);
  }
  canvas.curve({{box.left, box.top}, {box.left, box.bottom}, {box.right, box.bottom}}, 1, frame);
  canvas.text(0.5 * (box.left + box.right), box.bottom + 41, axes.x.name, small, Canvas::Align::centre);
  canvas.text_upwards(edge + 4, 0.5 * (box.top + box.bottom), axes.y.name, small);
}

void draw_series(Canvas& canvas, const Series& series, const Axes& axes, bool logarithmic) {
  const Look& look = look_of(series);
  const Curve shown = report::thinned(report::inside(series.curve, axes.x.lo, axes.x.hi), axes.x);
  std::vector<Place> line;
  const auto put_down = [&] {
    if (line.size() > 1 && !series.dots) canvas.curve(line, line_width, look.colour, look.dashes);
    line.clear();
  };
  for (std::size_t k = 0; k < shown.size(); ++k) {
    if (!report::usable(shown.time[k], logarithmic) || !report::usable(shown.value[k], logarithmic)) {
      put_down();
      continue;
    }
    line.push_back({axes.x(shown.time[k]), axes.y(shown.value[k])});
    if (series.dots || report::lonely(shown, k, logarithmic))
      canvas.ring(line.back().x, line.back().y, 4, line_width, look.colour);
  }
  put_down();
}

void draw_plot(Canvas& canvas, const Plot& plot, const std::vector<std::vector<Entry>>& legend, double y,
               const ChartOptions& options) {
  canvas.text(edge, y + 22, plot.title, large, Canvas::Align::left, true);
  draw_legend(canvas, legend, edge, y + title_height + 12);
  Box box = {.left = edge,
             .right = options.width - edge - 12,  // of the last number below
             .top = y + title_height + row * static_cast<double>(legend.size()) + 8,
             .bottom = y + options.height_of_plot - below};
  Axes axes = *axes_of(plot, box);
  double widest = 0;
  for (const auto& [value, text] : axes.y.ticks(6)) widest = std::max(widest, canvas.text_width(text, small));
  box.left = axes.x.from = edge + 4 + small + 9 + widest;
  for (const ReferenceLine& line : plot.references) {
    if (line.within <= 0) continue;
    const double from = line.over ? axes.x(line.over->first) : box.left;
    const double to = line.over ? axes.x(line.over->second) : box.right;
    const double top = axes.y(line.value + line.within);
    canvas.fill_rectangle(from, top, to - from, axes.y(line.value - line.within) - top, band);
  }
  draw_axes(canvas, axes, box);
  canvas.clip(box.left, box.top, box.right - box.left, box.bottom - box.top);
  for (const ReferenceLine& line : plot.references)
    if (report::usable(line.value, plot.logarithmic))
      canvas.curve({{line.over ? axes.x(line.over->first) : box.left, axes.y(line.value)},
                    {line.over ? axes.x(line.over->second) : box.right, axes.y(line.value)}},
                   1.5, ink, dotted);
  for (const Series& series : plot.series) draw_series(canvas, series, axes, plot.logarithmic);
  canvas.unclip();
  for (const Series& series : plot.series)
    if (series.marker && series.marker->time >= axes.x.lo && series.marker->time <= axes.x.hi)
      canvas.ring(axes.x(series.marker->time), axes.y(series.marker->value), 5.5, line_width,
                  look_of(series).colour);
}

}  // namespace

std::string chart(const std::vector<Plot>& plots, const ChartOptions& options, Canvas::Kind kind) {
  Canvas measure(kind, options.width, options.height_of_plot);
  std::vector<std::pair<const Plot*, std::vector<std::vector<Entry>>>> shown;
  for (const Plot& plot : plots)
    if (axes_of(plot, {}))
      shown.emplace_back(&plot, in_rows(measure, entries_of(plot), options.width - 2 * edge));
  if (shown.empty()) return {};
  Canvas canvas(kind, options.width, options.height_of_plot * static_cast<int>(shown.size()), options.ratio);
  double y = 0;
  for (const auto& [plot, legend] : shown) {
    draw_plot(canvas, *plot, legend, y, options);
    y += options.height_of_plot;
  }
  return canvas.finish();
}

}  // namespace strake::picture
