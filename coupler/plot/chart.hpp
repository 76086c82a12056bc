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

/// Draws plots one below the other, as the bytes of a PNG or SVG file. They have axes with units, curves in
/// different colours and dashes, and a legend. References are dashed, with the band of their tolerance; first
/// peaks are rings. Plots without a point in their window are left out; empty if none is left.
std::string chart(const std::vector<report::Plot>&, const ChartOptions&, Canvas::Kind);

/// The same of one plot as a figure of a page, with the legend as its caption.
std::string figure(const report::Plot&);

}  // namespace strake::picture
