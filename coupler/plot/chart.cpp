#include "coupler/plot/canvas.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/plot/plot.hpp"

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
using report::usable;

constexpr double small_letters = 13, large_letters = 16;  // [px] letters
constexpr double edge = 18, title_height = 34, row = 22;  // [px]
constexpr double below = 46;                              // [px] of a box, for numbers and name of the x axis
constexpr double sample_width = 28;                       // [px] of a line in the legend
constexpr double line_width = 2;                          // [px]
const Colour ink = {0.11, 0.13, 0.16};
const Style grid = {.name = "grid", .colour = {0.90, 0.92, 0.93}},
            axis = {.name = "axis", .colour = {0.31, 0.35, 0.40}},
            band = {.name = "band", .colour = {0.93, 0.94, 0.88}, .filled = true},
            reference = {.name = "reference", .colour = ink, .width = 1.5, .dashes = {2, 4}},
            ring = {.name = "ring", .colour = ink, .width = line_width};

/// The report's styles: colours of equal weight, and dashes for readers who cannot distinguish them.
Style style_of(const Series& series, const std::string& kind) {
  static const std::array<std::pair<Colour, std::vector<double>>, 8> known = {
      {{{0.043, 0.384, 0.769}, {}},
       {{0.761, 0.255, 0.047}, {9, 3}},
       {{0.067, 0.451, 0.294}, {4, 2}},
       {{0.545, 0.184, 0.690}, {10, 3, 2, 3}},
       {{0.541, 0.353, 0.000}, {6, 2, 1, 2}},
       {{0.055, 0.455, 0.565}, {14, 3}},
       {{0.706, 0.137, 0.373}, {3, 3}},
       {{0.341, 0.376, 0.416}, {8, 2, 3, 2}}}};
  const auto at = static_cast<std::size_t>(series.style) % known.size();
  return {.name = fmt::format("{} s{}", kind, at),
          .colour = known[at].first,
          .width = line_width,
          .dashes = kind == "line" ? known[at].second : std::vector<double>{}};
}

std::vector<Place> rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

/// One entry of the legend, and what its sample shows.
struct Entry {
  std::string text;
  const Series* series = nullptr;
  const ReferenceLine* reference = nullptr;  // neither: the ring of first peaks
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
    entries.push_back({.text = "first peak"});
  return entries;
}

void draw_sample(Sheet& sheet, const Entry& entry, double x, double y) {
  const std::vector<Place> line = {{x + 1, y}, {x + sample_width, y}};
  const Place middle = {x + 0.5 * sample_width, y};
  if (entry.reference != nullptr) {
    if (entry.reference->within > 0) sheet.path(rectangle(x + 1, y - 6, x + sample_width, y + 6), band);
    sheet.path(line, reference);
  } else if (entry.series != nullptr) {
    if (entry.series->line) sheet.path(line, style_of(*entry.series, "line"));
    if (entry.series->dots) sheet.circle(middle, 4, style_of(*entry.series, "dot"));
  } else {
    sheet.circle(middle, 4, ring);
  }
}

void draw_axes(Sheet& sheet, const Axes& axes, const Box& box, int wanted) {
  for (const auto& [value, text] : axes.x.ticks(wanted)) {
    const double at = axes.x(value);
    sheet.path({{at, box.top}, {at, box.bottom}}, grid);
    sheet.text(at, box.bottom + 18, text, small_letters, Align::centre);
  }
  for (const auto& [value, text] : axes.y.ticks(6)) {
    const double at = axes.y(value);
    sheet.path({{box.left, at}, {box.right, at}}, grid);
    sheet.text(box.left - 6, at + 4.5, text, small_letters, Align::right);
  }
  sheet.path({{box.left, box.top}, {box.left, box.bottom}, {box.right, box.bottom}}, axis);
  sheet.text(0.5 * (box.left + box.right), box.bottom + 38, axes.x.name, small_letters, Align::centre);
}

void draw_series(Sheet& sheet, const Series& series, const Axes& axes, bool logarithmic) {
  const Curve shown = report::thinned(report::inside(series.curve, axes.x.lo, axes.x.hi), axes.x);
  std::vector<Place> line, dots;
  const auto put_down = [&] {
    if (line.size() > 1 && series.line) sheet.path(line, style_of(series, "line"), series.name);
    line.clear();
  };
  for (std::size_t k = 0; k < shown.size(); ++k) {
    if (!usable(shown.time[k], logarithmic) || !usable(shown.value[k], logarithmic)) {
      put_down();
      continue;
    }
    line.push_back({axes.x(shown.time[k]), axes.y(shown.value[k])});
    if (series.dots || report::lonely(shown, k, logarithmic)) dots.push_back(line.back());
  }
  put_down();
  for (const Place& dot : dots) sheet.circle(dot, 4, style_of(series, "dot"));
}

/// Axes, references, curves and first peaks. The box holds the numbers and the name of the y axis as well.
void draw_plot(Sheet& sheet, const Plot& plot, Box box) {
  Axes axes = *axes_of(plot, box);
  double widest = 0;
  for (const auto& [value, text] : axes.y.ticks(6))
    widest = std::max(widest, sheet.text_width(text, small_letters));
  const double begin = box.left;
  box.left = axes.x.from = begin + std::max(58.0, 31 + widest);
  const auto from = [&](const ReferenceLine& line) {
    return line.over ? axes.x(line.over->first) : box.left;
  };
  const auto to = [&](const ReferenceLine& line) {
    return line.over ? axes.x(line.over->second) : box.right;
  };
  const auto clip = [&] { sheet.clip(box.left, box.top, box.right - box.left, box.bottom - box.top); };

  const bool bands = std::any_of(plot.references.begin(), plot.references.end(),
                                 [](const ReferenceLine& line) { return line.within > 0; });
  if (bands) clip();
  for (const ReferenceLine& line : plot.references)
    if (line.within > 0)
      sheet.path(
          rectangle(from(line), axes.y(line.value + line.within), to(line), axes.y(line.value - line.within)),
          band);
  if (bands) sheet.unclip();
  draw_axes(sheet, axes, box, static_cast<int>(4 + (box.right - begin) / 190));
  sheet.text(begin + 15, 0.5 * (box.top + box.bottom), axes.y.name, small_letters, Align::upwards);
  clip();
  for (const ReferenceLine& line : plot.references)
    if (usable(line.value, plot.logarithmic))
      sheet.path({{from(line), axes.y(line.value)}, {to(line), axes.y(line.value)}}, reference);
  for (const Series& series : plot.series) draw_series(sheet, series, axes, plot.logarithmic);
  sheet.unclip();
  for (const Series& series : plot.series)
    if (series.marker && series.marker->time >= axes.x.lo && series.marker->time <= axes.x.hi &&
        usable(series.marker->value, plot.logarithmic))
      sheet.circle({axes.x(series.marker->time), axes.y(series.marker->value)}, 5, style_of(series, "ring"));
}

/// Draws the entries in rows that are not wider than the picture; the height that they take.
double draw_legend(Sheet& sheet, const Plot& plot, double y, double width) {
  double x = 0;
  int rows = 1;
  for (const Entry& entry : entries_of(plot)) {
    const double own = sample_width + 6 + sheet.text_width(entry.text, small_letters) + 30;
    if (x > 0 && x + own > width) {
      x = 0;
      ++rows;
    }
    const double base = y + row * (rows - 1);
    draw_sample(sheet, entry, edge + x, base - 4);
    sheet.text(edge + x + sample_width + 6, base, entry.text, small_letters);
    x += own;
  }
  return row * rows;
}

}  // namespace

std::string chart(const std::vector<Plot>& plots, const ChartOptions& options, Canvas::Kind kind) {
  std::vector<const Plot*> shown;
  for (const Plot& plot : plots)
    if (axes_of(plot, {})) shown.push_back(&plot);
  if (shown.empty()) return {};
  Canvas canvas(kind, options.width, options.height_of_plot * static_cast<int>(shown.size()), options.ratio);
  double y = 0;
  for (const Plot* plot : shown) {
    canvas.text(edge, y + 22, plot->title, large_letters, Align::left, true);
    const double top = y + title_height;
    const double legend = draw_legend(canvas, *plot, top + 12, options.width - 2 * edge);
    draw_plot(canvas, *plot,
              {.left = 0.5 * edge,
               .right = options.width - edge - 12,  // of the last number below
               .top = top + legend + 8,
               .bottom = y + options.height_of_plot - below - 6});
    y += options.height_of_plot;
  }
  return canvas.finish();
}

std::string figure(const Plot& plot) {
  constexpr double width = 480, height = 300, room = 14;  // [px]
  if (!axes_of(plot, {})) return {};
  PageCanvas canvas(width, height);
  draw_plot(canvas, plot, {.left = 0, .right = width - room, .top = room, .bottom = height - below});
  std::string legend;
  for (const Entry& entry : entries_of(plot)) {
    PageCanvas sample(sample_width + 2, 12);
    draw_sample(sample, entry, 0, 6);
    legend += "<li>" + sample.svg("swatch") + report::escape(entry.text) + "</li>";
  }
  return fmt::format(
      "<figure>\n<div class=\"scroll\">{1}</div>\n<figcaption><strong>{0}</strong><ul "
      "class=\"legend\">{2}</ul></figcaption>\n</figure>\n",
      report::escape(plot.title), canvas.svg("plot", plot.title), legend);
}

}  // namespace strake::picture
