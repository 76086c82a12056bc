#pragma once

#include "coupler/plot/canvas.hpp"
#include "coupler/plot/plot.hpp"

#include <string>
#include <vector>

namespace strake::picture {

struct ChartOptions {
  int width = 800, height_of_plot = 420;  // [px]
  double ratio = 1;                       // pixels of a PNG per unit of width and height
};

/// Plots one below the other as the bytes of a PNG or SVG file: axes with units, curves told apart by colour
/// and dashes, references dashed with the band of their tolerance, first peaks as rings, and a legend. Plots
/// without a point in their window are left out; empty where that leaves none.
std::string chart(const std::vector<report::Plot>&, const ChartOptions&, Canvas::Kind);

}  // namespace strake::picture
