#pragma once

#include "coupler/compare/curve.hpp"
#include "coupler/plot/canvas.hpp"
#include "coupler/plot/ticks.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake::report {

/// One curve of a plot. `style` chooses colour and dashes, so that a run looks alike in every plot.
struct Series {
  std::string name = {};
  Curve curve = {};  // time: what runs along the x axis, not always a time
  int style = 0;
  std::optional<CurvePoint> marker = {};  // a ring: the first peak
  bool dots = false;                      // a dot at each sample (convergence, measured points)
  bool line = true;                       // between the samples
};

/// An expected value of a curve: a dashed line across the plot, or over its own part of x.
struct ReferenceLine {
  std::string name = {};
  double value = 0;
  std::optional<std::pair<double, double>> over = {};
  double within = 0;  // half the width of a band around it, the tolerance; 0: none
};

struct Plot {
  std::string title = {};
  std::string x_name = {}, x_unit = {}, y_name = {}, y_unit = {};
  std::vector<Series> series = {};
  std::vector<ReferenceLine> references = {};
  std::optional<std::pair<double, double>> window = {};  // of x; all
  bool logarithmic = false;                              // both axes
};

/// One direction of a plot: from values to pixels, with its ticks.
struct Axis {
  double lo = 0, hi = 1, from = 0, to = 1;
  bool logarithmic = false;
  Prefix prefix = {};
  std::string name = {};  // with its unit

  double operator()(double value) const;
  /// Value and text of about so many round numbers within the range.
  std::vector<std::pair<double, std::string>> ticks(int wanted) const;
};

/// The edges of the part with the curves [px], y downwards.
struct Box {
  double left = 0, right = 0, top = 0, bottom = 0;
};

struct Axes {
  Axis x, y;
};
/// The axes for all curves, references and markers of a plot inside the box. None if no curve has a point in
/// the plot's window.
std::optional<Axes> axes_of(const Plot&, const Box&);

/// Finite, and positive on a logarithmic axis.
bool usable(double value, bool logarithmic);
/// The samples inside [lo, hi], and one on either side so that the line runs to the edge.
Curve inside(const Curve&, double lo, double hi);
/// Of many samples the first, last, least and largest of each pixel column: the drawn line is the same.
Curve thinned(const Curve&, const Axis& x);
/// A sample without a usable one beside it, which no line shows.
bool lonely(const Curve&, std::size_t sample, bool logarithmic);

}  // namespace strake::report

namespace strake::picture {

struct ChartOptions {
  int width = 800, height_of_plot = 420;  // [px]
  double ratio = 1;                       // pixels of a PNG per unit of width and height
};

/// Draws plots one below the other, as the bytes of a PNG or SVG file. They have axes with units, curves in
/// different colours and dashes, and a legend. References are dashed, with the band of their tolerance; first
/// peaks are rings. Plots without a point in their window are left out; empty if none is left.
std::string chart(const std::vector<report::Plot>&, const ChartOptions&, Canvas::Kind);

/// The same of one plot as a figure of a page, with the legend as its caption.
std::string figure(const report::Plot&);

}  // namespace strake::picture
