#include "coupler/commands/compare_plots.hpp"

#include "coupler/plot/ticks.hpp"
#include "proto/error.hpp"
#include "proto/files/result_file.hpp"

#include <algorithm>
#include <cmath>

namespace strake {

namespace {

constexpr double fine = 2;  // pixels of a PNG per unit, for fine screens

const MetricRow* row_of(const Comparison& comparison, const std::string& name) {
  for (const MetricRow& row : comparison.rows)
    if (row.name == name) return &row;
  return nullptr;
}

/// "deflection" of "mid.y", as the case asks for it; empty where it does not.
std::string quantity_of(const std::string& column, const std::vector<ProbeKeys>& probes) {
  for (const ProbeKeys& probe : probes)
    if (column == probe.name || column.starts_with(probe.name + ".")) return probe.quantity;
  return {};
}

}  // namespace

picture::Canvas::Kind kind_of_plot(const std::filesystem::path& path) {
  return picture::kind_of(path, "--plot", "a plot", "compare.svg");
}

void write_plots(const std::filesystem::path& path, const std::vector<report::Plot>& plots) {
  const std::string bytes = picture::chart(plots, {.ratio = fine}, kind_of_plot(path));
  if (bytes.empty())
    throw Error(ExitCode::command_line, "--plot " + path.string(), "there is no curve to draw",
                "--probe NAME chooses a quantity that was recorded over time");
  write_text(path, bytes);
}

report::Plot overlay_plot(const std::string& quantity, const std::vector<Record>& records,
                          const Comparison& comparison) {
  report::Plot plot;
  plot.title = plot.y_name = quantity;
  plot.x_name = "time";
  plot.x_unit = "s";
  plot.y_unit = records.front().unit;
  plot.window = {comparison.from, comparison.to};
  const MetricRow *value = row_of(comparison, "first_peak"), *time = row_of(comparison, "time_of_first_peak");
  for (std::size_t r = 0; r < records.size(); ++r) {
    report::Series series = {
        .name = records[r].name, .curve = records[r].curve, .style = static_cast<int>(r)};
    if (value != nullptr && time != nullptr && value->value[r] && time->value[r])
      series.marker = CurvePoint{comparison.origin[r] + *time->value[r], *value->value[r]};
    plot.series.push_back(std::move(series));
  }
  return plot;
}

std::vector<report::Plot> reference_plots(const std::vector<CompareBlock>& blocks, const RunData& data,
                                          const std::string& run_name, const std::vector<ProbeKeys>& probes) {
  std::vector<report::Plot> plots;
  for (const CompareBlock& block : blocks) {
    const auto column = data.history == nullptr ? std::nullopt : data.history->find(block.probe);
    if (!column) continue;
    const std::string quantity = quantity_of(block.probe, probes);
    const std::string title = quantity.empty() ? block.probe : quantity + " " + block.probe;
    const auto same = [&](const report::Plot& plot) { return plot.title == title; };
    auto plot = std::find_if(plots.begin(), plots.end(), same);
    if (plot == plots.end()) {
      report::Plot fresh;
      fresh.title = title;
      fresh.y_name = quantity.empty() ? block.probe : quantity;
      fresh.x_name = "time";
      fresh.x_unit = "s";
      fresh.y_unit = data.history->columns[*column].unit;
      report::Series own = {.name = run_name, .curve = curve_of(*data.history, block.probe)};
      const auto value = data.monitor.find(block.probe + ":first_peak"),
                 time = data.monitor.find(block.probe + ":time_of_first_peak");
      if (value != data.monitor.end() && time != data.monitor.end())
        own.marker = CurvePoint{time->second, value->second};
      fresh.series.push_back(std::move(own));
      plots.push_back(std::move(fresh));
      plot = std::prev(plots.end());
    }
    for (const CompareBlock::Metric& metric : block.metrics) {
      if (!is_value_of_curve(metric.name)) continue;
      const double value = metric.value * block.divide_by;
      const double within = metric.value == 0 ? metric.tolerance * std::abs(block.divide_by)
                                              : metric.tolerance * std::abs(value);
      plot->references.push_back(
          {.name = in_words(metric.name) + ", " + block.kind, .value = value, .within = within});
    }
    if (!block.file.empty())
      plot->series.push_back({.name = block.file.stem().string() + ", " + block.kind,
                              .curve = reference_curve(block),
                              .style = static_cast<int>(plot->series.size()),
                              .dots = true,
                              .line = false});
  }
  return plots;
}

}  // namespace strake
