// Histories of all runs in one plot per quantity, whole and around the first peak.
#include "coupler/compare/comparison.hpp"
#include "coupler/plot/html.hpp"
#include "coupler/plot/plot.hpp"
#include "coupler/plot/ticks.hpp"
#include "coupler/report/sections.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace strake::report {
namespace {

/// A column of history.csv that the report plots.
struct Recording {
  std::string column, unit;
};

double largest(const std::vector<Recorded>& runs, const std::string& column) {
  double most = 0;
  for (const Recorded& run : runs)
    if (const auto point = peak(curve_of(run.history, column))) most = std::max(most, std::abs(point->value));
  return most;
}

/// Columns of the probes in the order of the case, a pressure's impulse after it, and the force.
std::vector<Recording> recordings(const std::vector<Recorded>& runs) {
  std::vector<Recording> found;
  const auto take = [&](const std::string& column) {
    if (std::any_of(found.begin(), found.end(), [&](const Recording& r) { return r.column == column; }))
      return;
    for (const Recorded& run : runs)
      if (const auto c = run.history.find(column)) {
        found.push_back({column, run.history.columns[*c].unit});
        return;
      }
  };
  for (const Recorded& run : runs)
    for (int i = 0;; ++i) {
      const std::string name = run.setting(fmt::format("output.probe[{}].name", i));
      if (name.empty()) break;
      take(name);
      take(name + ".impulse");
      for (const char* axis : {".x", ".y", ".z"}) take(name + axis);
    }
  for (const Recorded& run : runs)
    for (const ProbeResult& result : run.probes) take(result.probe);
  take("force.y");
  // A component that is a thousandth of its sisters is round-off, not a finding; of a moment as well what a
  // lever arm of a micrometre makes of the force.
  std::erase_if(found, [&](const Recording& r) {
    double of_sisters = 0;
    for (const Recorded& run : runs)
      for (const Column& column : run.history.columns)
        if (vector_of(column.name) == vector_of(r.column) && (is_moment(r.column) || !is_moment(column.name)))
          of_sisters = std::max(of_sisters, (is_moment(r.column) && !is_moment(column.name) ? 1e-3 : 1) *
                                                largest(runs, column.name));
    return of_sisters == 0 || largest(runs, r.column) < 1e-3 * of_sisters;
  });
  return found;
}

/// The first peak; none where a quantity falls towards it, from its start or from before the contact.
std::optional<CurvePoint> first_peak_of(const Recorded& run, const std::string& column) {
  const ProbeResult* result = run.probe(column);
  if (result == nullptr) return std::nullopt;
  const auto value = result->metric("first_peak"), time = result->metric("time_of_first_peak");
  if (!value || !time) return std::nullopt;
  const CurvePoint point{*time, *value};
  const bool begins_with_contact = run.contact.contains(column) || (is_load(column) && !run.contact.empty());
  if (falls_towards(curve_of(run.history, column), point, begins_with_contact)) return std::nullopt;
  return point;
}

/// Half the width of the band that the tolerance allows round a reference.
double half_band(const study::CheckResult& judged) {
  const double tolerance = judged.tolerance.value_or(0), reference = judged.reference.value_or(0);
  return reference == 0 ? tolerance : tolerance * std::abs(reference);
}

/// The time that a window of a block covers in a run; none where its contact is not known.
std::optional<std::pair<double, double>> time_of(const CompareBlock::Span& window, const Recorded& run,
                                                 const std::string& probe) {
  double origin = 0;
  if (window.after == "contact") {
    if (run.contact.empty()) return std::nullopt;
    const auto own = run.contact.find(probe);
    const auto earliest =
        std::ranges::min_element(run.contact, {}, [](const auto& contact) { return contact.second; });
    origin = own != run.contact.end() ? own->second : earliest->second;
  }
  const double unit = window.shares ? run.end_time.value_or(0) - origin : 1;
  return std::pair{origin + unit * window.from, origin + unit * window.to};
}

/// References of the metrics that are values of the curve itself. Those of an impulse belong to its own
/// column.
std::vector<ReferenceLine> lines_for(const std::vector<Recorded>& runs, const std::string& column) {
  const bool impulse = column.ends_with(".impulse");
  const std::string probe = impulse ? column.substr(0, column.size() - 8) : column;
  std::vector<ReferenceLine> lines;
  for (const Recorded& run : runs)
    for (const study::CheckResult& judged : run.compare) {
      if (judged.probe != probe) continue;
      if (impulse ? judged.metric != "impulse" : !is_value_of_curve(judged.metric)) continue;
      ReferenceLine line = {.name = in_words(judged.metric) + ", " + judged.kind,
                            .value = judged.reference.value_or(0)};
      line.within = half_band(judged);
      const CompareBlock* block = run.block_of(judged);
      if (block != nullptr &&
          (block->divide_by != 1 || (impulse && block->window && !is_of_contact(*block->window))))
        continue;
      if (impulse) {
        const double from = at_or(run.contact, probe);
        line.name = "impulse of the first 300 µs, " + judged.kind;  // cases/VALIDATION.md, "Definitions"
        line.over = {from, from + 300e-6};
      } else if (block != nullptr && block->window) {
        line.over = time_of(*block->window, run, probe);
      }
      if (std::none_of(lines.begin(), lines.end(),
                       [&](const ReferenceLine& l) { return l.value == line.value && l.name == line.name; }))
        lines.push_back(line);
    }
  return lines;
}

/// Adds the reference curves of the column, as rings; each once.
void add_reference_curves(const std::vector<Recorded>& runs, const std::string& column, Plot& plot) {
  for (const Recorded& run : runs)
    for (const ReferenceCurve& reference : run.reference_curves)
      if (reference.probe == column &&
          std::ranges::none_of(plot.series, [&](const Series& s) { return s.name == reference.name; }))
        plot.series.push_back({.name = reference.name,
                               .curve = reference.curve,
                               .style = static_cast<int>(plot.series.size()),
                               .dots = true,
                               .line = false});
}

/// From before the contact to a while after the last first peak.
std::optional<std::pair<double, double>> around_first_peak(const std::vector<Recorded>& runs,
                                                           const std::string& column) {
  double first = 1e300, last = -1e300, end = 0, window = 0;
  for (const Recorded& run : runs) {
    const auto point = first_peak_of(run, column);
    if (!point) continue;
    last = std::max(last, point->time);
    first = std::min(first, at_or(run.contact, column, point->time));
    end = std::max(end, run.end_time.value_or(0));
    if (run.windows && *run.windows > 0) window = std::max(window, run.end_time.value_or(0) / *run.windows);
  }
  if (!(first <= last)) return std::nullopt;
  const double width = std::max({last - first, 12 * window, 0.02 * last});
  const std::pair<double, double> around = {std::max(0.0, first - 0.5 * width),
                                            std::min(end, last + 1.5 * width)};
  // A zoom that shows half of all is no zoom.
  if (around.second - around.first > 0.5 * end) return std::nullopt;
  return around;
}

/// What a probe measures, by the case: "deflection", "pressure".
std::string measured(const std::vector<Recorded>& runs, const std::string& column) {
  for (const Recorded& run : runs)
    for (int i = 0;; ++i) {
      const std::string probe = fmt::format("output.probe[{}]", i), name = run.setting(probe + ".name");
      if (name.empty()) break;
      const bool own = column == name || (column.starts_with(name + ".") && column.size() == name.size() + 2);
      if (own) return run.setting(probe + ".quantity");
    }
  return {};
}

}  // namespace

Names names_of(const std::vector<Recorded>& runs, const std::string& column) {
  if (column.ends_with(".impulse"))
    return {"impulse of " + column.substr(0, column.size() - 8) + " since contact", "impulse"};
  if (column == "force.y") return {"force on the structure, upwards", "force"};
  if (column.starts_with("force.")) return {column + " on the structure", "force"};
  if (column.starts_with("moment.")) return {column + " on the structure, about its middle", "moment"};
  const std::string quantity = measured(runs, column);
  return quantity.empty() || quantity == column ? Names{column, column}
                                                : Names{quantity + " " + column, quantity};
}

std::string history_figures(const std::vector<Recorded>& runs, const std::string& heading) {
  std::string body;
  for (const Recording& recording : recordings(runs)) {
    Plot plot;
    const Names names = names_of(runs, recording.column);
    plot.title = (heading.empty() ? "" : heading + ": ") + names.title;
    plot.x_name = "time";
    plot.x_unit = "s";
    plot.y_name = names.axis;
    plot.y_unit = recording.unit;
    const double most = largest(runs, recording.column);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      Series series = {.name = runs[i].name,
                       .curve = curve_of(runs[i].history, recording.column),
                       .style = static_cast<int>(i),
                       .marker = first_peak_of(runs[i], recording.column),
                       .dots = false};
      if (series.marker && std::abs(series.marker->value) < 1e-3 * most) series.marker.reset();  // round-off
      if (series.curve.size() > 0) plot.series.push_back(std::move(series));
    }
    plot.references = lines_for(runs, recording.column);
    add_reference_curves(runs, recording.column, plot);
    body += picture::figure(plot);
    plot.window = around_first_peak(runs, recording.column);
    if (!plot.window) continue;
    plot.title += ", around the first peak";
    body += picture::figure(plot);
  }
  return body.empty() ? body : "<div class=\"figures\">\n" + body + "</div>\n";
}

std::string histories(const std::vector<Recorded>& runs) {
  const std::string figures = history_figures(runs, "");
  if (figures.empty()) return {};
  return section(
      "histories", "Histories",
      "<p>Lines join the values at the ends of windows; a ring is the first peak as measured at "
      "every step, which may stand between and above them. References are dashed, with the band that their "
      "tolerance allows; a reference that is a curve is drawn as points.</p>\n" +
          figures);
}

}  // namespace strake::report
