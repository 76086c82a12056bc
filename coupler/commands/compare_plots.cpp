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

/// Title of a column's plot: "deflection mid.y"; of a probe that is called as its quantity that word alone.
std::string title_of(const std::string& column, const std::vector<ProbeKeys>& probes) {
  const std::string quantity = quantity_of(column, probes);
  return quantity.empty() || quantity == column ? column : quantity + " " + column;
}

/// A plot of one column of the run's history, with its first peak; it holds no reference yet.
report::Plot plot_of(const std::string& column, const RunData& data, const std::string& run_name,
                     const std::vector<ProbeKeys>& probes) {
  const std::string quantity = quantity_of(column, probes);
  report::Plot plot;
  plot.title = title_of(column, probes);
  plot.y_name = quantity.empty() ? column : quantity;
  plot.x_name = "time";
  plot.x_unit = "s";
  plot.y_unit = data.history->columns[*data.history->find(column)].unit;
  report::Series own = {.name = run_name, .curve = curve_of(*data.history, column)};
  const auto value = data.monitor.find(column + ":first_peak"),
             time = data.monitor.find(column + ":time_of_first_peak");
  if (value != data.monitor.end() && time != data.monitor.end())
    own.marker = CurvePoint{time->second, value->second};
  plot.series.push_back(std::move(own));
  return plot;
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

std::vector<report::Plot> run_plots(const std::vector<CompareBlock>& blocks, const RunData& data,
                                    const std::string& run_name, const std::vector<ProbeKeys>& probes,
                                    const std::vector<std::string>& asked) {
  std::vector<report::Plot> plots;
  const auto plot_with = [&](const std::string& column) {
    const auto same = [&](const report::Plot& plot) { return plot.title == title_of(column, probes); };
    const auto plot = std::find_if(plots.begin(), plots.end(), same);
    return plot != plots.end() ? plot : plots.insert(plots.end(), plot_of(column, data, run_name, probes));
  };
  const auto recorded = [&](const std::string& column) {
    return data.history != nullptr && data.history->find(column);
  };
  for (const CompareBlock& block : blocks) {
    if (!recorded(block.probe)) continue;
    const auto plot = plot_with(block.probe);
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
  for (const std::string& column : asked) {
    data.history->column(column);  // refuses a name that the run has not recorded
    plot_with(column);
  }
  return plots;
}

}  // namespace strake
