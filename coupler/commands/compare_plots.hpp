#pragma once

#include "coupler/compare/compare.hpp"
#include "coupler/compare/comparison.hpp"
#include "coupler/plot/canvas.hpp"
#include "coupler/plot/plot.hpp"
#include "proto/case/case_keys.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// The plots of strake compare.

/// Throws Error(command_line) unless it is a .png or an .svg.
picture::Canvas::Kind kind_of_plot(const std::filesystem::path&);

/// The plots one below the other. Throws Error(command_line) where there is nothing to draw.
void write_plots(const std::filesystem::path&, const std::vector<report::Plot>&);

/// All records of one quantity over the span of their comparison, with the first peak of each.
report::Plot overlay_plot(const std::string& quantity, const std::vector<Record>&, const Comparison&);

/// Plots a run against the expectations of its case, one plot for each probe of the blocks. Values of peaks,
/// means and final values are references, beside the points of reference curves. Plots are named as the case
/// names them. Columns that the user asked for have a plot without a reference as well.
std::vector<report::Plot> run_plots(const std::vector<CompareBlock>&, const RunData&,
                                    const std::string& run_name, const std::vector<ProbeKeys>&,
                                    const std::vector<std::string>& asked);

}  // namespace strake
