#pragma once

#include "coupler/compare/curve.hpp"

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

}  // namespace strake::report
