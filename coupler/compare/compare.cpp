#include "coupler/compare/compare.hpp"

#include "coupler/compare/record.hpp"
#include "proto/lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace strake {
namespace {

using Metric = CompareBlock::Metric;

// Two times are the same within this part of them.
constexpr double slack = 1e-9;

std::optional<double> known(const RunData& data, const std::string& name) {
  const double value = at_or(data.monitor, name, std::nan(""));
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Whether a participant keeps a record of this probe: it tells a metric of it, at least the last value.
bool has_record(const RunData& data, const std::string& probe) {
  const auto found = data.monitor.lower_bound(probe + ":");
  return found != data.monitor.end() && found->first.starts_with(probe + ":");
}

/// Contact time of a probe. Contact is one moment of the whole body: a probe without its own takes the
/// earliest of the others.
std::optional<double> contact_time(const RunData& data, const std::string& probe) {
  if (const auto own = known(data, probe + ":contact")) return own;
  std::optional<double> earliest;
  for (const auto& [name, time] : data.monitor)
    if (name.ends_with(":contact") && std::isfinite(time) && (!earliest || time < *earliest)) earliest = time;
  return earliest;
}

/// Whether the first peak that a probe's record tells is the value with which the quantity began.
bool is_of_start(const RunData& data, const std::string& probe) {
  const auto value = known(data, probe + ":first_peak"), time = known(data, probe + ":time_of_first_peak");
  if (!value || !time || !data.history) return false;
  const bool begins_with_contact =
      known(data, probe + ":contact") || (is_load(probe) && contact_time(data, probe));
  return falls_towards(curve_of(*data.history, probe), {*time, *value}, begins_with_contact);
}

/// Mean over [from, to] of a column whose values are means since the line before.
double mean_of_means(const Curve& c, double from, double to) {
  double sum = 0, length = 0, before = std::min(from, c.time.front());
  for (std::size_t k = 0; k < c.size(); ++k) {
    const double overlap = std::min(to, c.time[k]) - std::max(from, before);
    if (overlap > 0) {
      sum += overlap * c.value[k];
      length += overlap;
    }
    before = c.time[k];
  }
  return length > 0 ? sum / length : value_at(c, to);
}

/// Largest |q| within (from, to] of the record's columns: extremes within each window where the solver gives
/// them.
std::optional<CurvePoint> largest(const Table& history, const std::string& probe, double from, double to) {
  std::optional<CurvePoint> best;
  for (const char* suffix : {"", ".min", ".max"}) {
    const Curve c = curve_of(history, probe + suffix);
    for (std::size_t k = 0; k < c.size(); ++k)
      if (c.time[k] > from && c.time[k] <= to * (1 + slack) &&
          (!best || std::abs(c.value[k]) > std::abs(best->value)))
        best = {c.time[k], c.value[k]};
  }
  return best;
}

/// Its own points within [from, to]: deviations are taken where the reference was measured.
Curve points_within(const Curve& c, double from, double to) {
  Curve part;
  for (std::size_t k = 0; k < c.size(); ++k)
    if (c.time[k] >= from - slack * std::abs(from) && c.time[k] <= to * (1 + slack)) {
      part.time.push_back(c.time[k]);
      part.value.push_back(c.value[k]);
    }
  return part;
}

std::optional<double> from_history(const CompareBlock& block, const std::string& metric, const RunData& data,
                                   double from, double to) {
  if (!data.history) return std::nullopt;
  if (metric == "impulse") {
    const Curve running = curve_of(*data.history, block.probe + ".impulse");
    if (running.size() > 0) return value_at(running, to) - value_at(running, from);
  }
  if (metric == "peak" || metric == "time_of_peak") {
    const auto point = largest(*data.history, block.probe, from, to);
    if (!point || (metric == "time_of_peak" && point->value == 0)) return std::nullopt;
    return metric == "peak" ? point->value : point->time;
  }
  if (metric == "mean") {
    const Curve means = curve_of(*data.history, block.probe + ".mean");
    if (means.size() > 0) return mean_of_means(means, from, to);
  }
  const Curve curve = curve_of(*data.history, block.probe);
  if (curve.size() == 0) return std::nullopt;
  // A row of a load is the mean of its window.
  if (metric == "impulse" && is_load(block.probe)) return impulse_of_means(curve, from, to);
  if (metric == "mean" && is_load(block.probe) && to > from)
    return impulse_of_means(curve, from, to) / (to - from);
  if (metric == "impulse") return impulse(curve, from, to);
  if (metric == "mean") return mean(curve, from, to);
  if (metric == "rms") return rms(curve, from, to);
  if (metric == "noise") return noise(curve, from, to);
  if (metric == "slope") return slope(curve, from, to);
  if (metric == "period") return period(curve, from, to);
  if (metric == "onset") return onset(curve, from, to);
  if (metric == "drift") return slope(curve, from, to) * (to - from);
  if (metric == "final") return value_at(curve, to);
  if (metric == "largest_deviation" || metric == "mean_deviation") {
    const Curve reference = reference_curve(block);
    // Without a window the whole reference counts, so that the run must have reached its end.
    if (!block.window && reference.time.back() > to * (1 + slack)) return std::nullopt;
    const Curve points = points_within(reference, from, to);
    if (points.size() == 0) return std::nullopt;
    const Deviation off = deviation(curve, points);
    return metric == "mean_deviation" ? off.mean : off.largest;
  }
  const Curve part = clip(curve, from, to);
  if (metric == "l2" || metric == "dtw") {
    const Curve whole = reference_curve(block);
    const Curve reference = clip(whole, std::max(from, whole.time.front()), std::min(to, whole.time.back()));
    return metric == "l2" ? l2_difference(part, reference) : time_warping(part, reference);
  }
  if (metric == "mean_peak_50us") {
    const auto point = peak_of_mean(part, 50e-6);
    return point ? std::optional(point->value) : std::nullopt;
  }
  const auto point = first_peak(part, from);
  if (!point || falls_towards(curve, *point, contact_time(data, block.probe).has_value()))
    return std::nullopt;
  return metric == "first_peak" ? point->value : point->time;
}

/// The measured value as soon as nothing later can change it.
std::optional<double> measured(const CompareBlock& block, const std::string& metric, const RunData& data) {
  const std::string name = block.probe + ":" + metric;
  if (block.window) {
    double origin = 0;
    if (block.window->after == "contact") {
      const auto contact = contact_time(data, block.probe);
      if (!contact) return std::nullopt;
      origin = *contact;
      // The probe's own record runs from step to step; the history only from window to window.
      if (metric == "impulse" && is_of_contact(*block.window))
        if (const auto value = known(data, name)) return value;
    }
    if (block.window->shares) {
      const double length = data.time - origin;
      if (!data.finished || !(length > 0)) return std::nullopt;
      return from_history(block, metric, data, origin + block.window->from * length,
                          origin + block.window->to * length);
    }
    const double to = origin + block.window->to;
    if (data.time < to * (1 - slack)) return std::nullopt;
    return from_history(block, metric, data, origin + block.window->from, to);
  }
  const bool settles = metric == "first_peak" || metric == "time_of_first_peak" || metric == "impulse";
  if (!settles && !data.finished) return std::nullopt;
  if (const auto value = known(data, name))
    return metric.ends_with("first_peak") && is_of_start(data, block.probe) ? std::nullopt : value;
  // A probe's own record is the only source of what its definition ties to steps. A column without such a
  // record (of a solver of another's, or a force) has the lines of history.csv, once they are complete.
  const bool of_steps = settles || metric == "peak" || metric == "time_of_peak" || metric == "mean_peak_50us";
  if (of_steps && (!data.finished || has_record(data, block.probe))) return std::nullopt;
  if (!settles) return from_history(block, metric, data, 0, data.time);
  const double begin = contact_time(data, block.probe).value_or(0);
  const double end = metric == "impulse" ? begin + impulse_window : data.time;
  if (data.time < end * (1 - slack)) return std::nullopt;
  return from_history(block, metric, data, begin, end);
}

bool is_magnitude(const std::string& metric) {
  return metric == "first_peak" || metric == "peak" || metric == "mean_peak_50us";
}

std::string percent(double part) {
  return fmt::format("{:.3g} %", 100 * part);
}

}  // namespace

Curve reference_curve(const CompareBlock& block) {
  const Table table = read_given_table(block.file);
  Curve curve{table.value[0], block.column.empty() ? table.value[1] : table.column(block.column)};
  for (double& t : curve.time) t = block.axes.time_zero + block.axes.time * t;
  for (double& q : curve.value) q = block.axes.value_zero + block.axes.value * q;
  return curve;
}

double Verdict::deviation() const {
  return value ? strake::deviation(*value, reference) : std::numeric_limits<double>::quiet_NaN();
}

std::string Verdict::line() const {
  const std::string origin = kind + (source.empty() ? ", no source named" : ": " + source);
  const bool relative = reference != 0;
  const std::string bound = relative ? percent(tolerance) : fmt::format("{:g}", tolerance);
  if (result == Result::not_reached || !value)
    return fmt::format("not reached  {} {}, expected {:.4g} within {}, {}", probe, metric, reference, bound,
                       origin);
  const bool pass = result == Result::pass;
  const std::string off =
      relative ? fmt::format("{:+.1f} %", 100 * deviation()) : fmt::format("{:+.3g}", deviation());
  return fmt::format("{}  {} {} {:.4g}, expected {:.4g}: {} ({} {}), {}", pass ? "pass" : "FAIL", probe,
                     metric, *value, reference, off, pass ? "within" : "outside", bound, origin);
}

std::vector<Verdict> judge(const CompareBlock& block, const RunData& data) {
  std::vector<Verdict> verdicts;
  for (const Metric& metric : block.metrics) {
    Verdict v;
    v.probe = block.probe;
    v.metric = metric.name;
    v.reference = metric.value;
    v.tolerance = metric.tolerance;
    v.kind = block.kind;
    v.source = block.source;
    v.value = measured(block, metric.name, data);
    if (v.value) {
      v.value = *v.value / block.divide_by;
      // A peak that the case gives without a sign is one of |q|.
      if (is_magnitude(metric.name) && metric.value >= 0) v.value = std::abs(*v.value);
      const bool within = std::abs(v.deviation()) <= metric.tolerance;  // false for NaN
      v.result = within ? Verdict::Result::pass : Verdict::Result::fail;
    }
    verdicts.push_back(std::move(v));
  }
  return verdicts;
}

std::vector<Verdict> judge(const std::vector<CompareBlock>& blocks, const RunData& data,
                           const CaseLookup& lookup) {
  std::vector<Verdict> verdicts;
  for (const CompareBlock& block : blocks)
    if (applies(block, lookup))
      for (Verdict& v : judge(block, data)) verdicts.push_back(std::move(v));
  return verdicts;
}

}  // namespace strake
