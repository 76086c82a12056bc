#include "coupler/compare/comparison.hpp"

#include "proto/error.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

constexpr std::size_t most_points = 2000;  // time warping costs their square

Curve at_equal_steps(const Curve& c, double from, double to, std::size_t n) {
  std::vector<double> times;
  for (std::size_t k = 0; k < n; ++k)
    times.push_back(from + (to - from) * static_cast<double>(k) / static_cast<double>(n - 1));
  return resample(c, times);
}

/// ∫ of the window means if a run has them (steps within a window count), else of the history's lines.
double impulse_of(const Record& r, double from, double to) {
  return r.means.size() == 0 ? impulse(r.curve, from, to) : impulse_of_means(r.means, from, to);
}

/// The peak over all steps within the span, where the run has told it; else that of its rows' extremes.
std::optional<CurvePoint> peak_in_span(const Record& r, double from, double to) {
  if (r.peak && r.peak->time >= from && r.peak->time <= to) return r.peak;
  if (r.extremes.size() == 0) return peak(clip(r.curve, from, to));
  Curve part;
  for (std::size_t k = 0; k < r.extremes.size(); ++k)
    if (r.extremes.time[k] >= from && r.extremes.time[k] <= to) {
      part.time.push_back(r.extremes.time[k]);
      part.value.push_back(r.extremes.value[k]);
    }
  return peak(part);
}

/// The same for the first peak after `origin`. A span that begins later has another first peak than the run.
std::optional<CurvePoint> first_peak_in_span(const Record& r, double origin, double from, double to) {
  const bool told = r.first_peak && (from <= origin || from <= r.curve.time.front());
  if (told && r.first_peak->time >= from && r.first_peak->time <= to) return r.first_peak;
  const Curve& curve = r.extremes.size() > 0 ? r.extremes : r.curve;
  const auto point = first_peak(clip(curve, from, to), std::max(from, origin));
  return point && !falls_towards(curve, *point, r.contact.has_value()) ? point : std::nullopt;
}

}  // namespace

const std::vector<std::string>& record_metrics() {
  static const std::vector<std::string> names = {
      "first_peak", "time_of_first_peak", "peak", "time_of_peak", "impulse", "mean", "rms",
      "final",      "frequency",          "l2",   "dtw"};
  return names;
}

double shift_onto(const Record& first, const Record& other, const std::string& how) {
  if (how == "contact") {
    if (!first.contact || !other.contact)
      throw Error(ExitCode::command_line, (first.contact ? other : first).name, "has no moment of contact",
                  "give --shift a time in s, or `peak`");
    return *first.contact - *other.contact;
  }
  if (how == "peak") {
    const auto one = first_peak(first.curve, first.curve.time.front());
    const auto two = first_peak(other.curve, other.curve.time.front());
    if (!one || !two)
      throw Error(ExitCode::command_line, (one ? other : first).name, "has no first peak",
                  "give --shift a time in s, or `contact`");
    return one->time - two->time;
  }
  const auto seconds = number_from<double>(how);
  if (!seconds || !std::isfinite(*seconds))
    throw Error(ExitCode::command_line, "--shift " + how, "is no time",
                "a number of seconds, `contact` or `peak`");
  return *seconds;
}

bool is_value_of_curve(const std::string& metric) {
  return metric == "first_peak" || metric == "peak" || metric == "final" || metric == "mean";
}

std::string metric_unit(const std::string& metric, const std::string& unit) {
  if (metric.starts_with("time_of_") || metric == "period" || metric == "onset") return "s";
  if (metric == "l2" || metric == "dtw") return "1";
  if (metric == "frequency") return "Hz";
  if (metric == "slope") return unit == "m/s" ? "m/s^2" : unit + "/s";
  if (metric != "impulse") return unit;
  return unit == "1" ? "s" : unit + " s";
}

namespace {

/// What the records have in common in time, within what is asked for. Throws Error(command_line) where that
/// is nothing, or their units differ.
Comparison common_span(const std::vector<Record>& records, const std::string& quantity,
                       const ComparisonSpan& span) {
  Comparison result;
  const Record& first = records.front();
  result.from = first.curve.time.front();
  result.to = first.curve.time.back();
  result.after_contact = true;
  for (const Record& r : records) {
    if (r.unit != first.unit)
      throw Error(
          ExitCode::command_line, r.name,
          fmt::format("{} is in \"{}\", in {} in \"{}\"", quantity, r.unit, first.name, first.unit),
          "compare another quantity (--probe NAME; forces in the plane are per metre of depth), or give the "
          "column its unit in the header: uy [mm]");
    result.from = std::max(result.from, r.curve.time.front());
    result.to = std::min(result.to, r.curve.time.back());
    result.after_contact = result.after_contact && r.contact.has_value();
  }
  if (span.from) result.from = std::max(result.from, *span.from);
  if (span.to) result.to = std::min(result.to, *span.to);
  if (!(result.to > result.from))
    throw Error(ExitCode::command_line, quantity,
                fmt::format("the records share no time: {:.6g} to {:.6g} s", result.from, result.to),
                "shift one with --shift S, or widen --from and --to");
  return result;
}

/// The values of one metric and their deviations from the first record's.
MetricRow row_of(const std::string& name, const std::string& unit,
                 const std::vector<std::optional<double>>& values) {
  MetricRow row = {.name = name, .unit = metric_unit(name, unit), .value = values, .deviation = {}};
  const bool difference = name == "l2" || name == "dtw";
  const auto& one = values.front();
  for (std::size_t r = 0; r < values.size(); ++r) {
    if (r == 0 || !values[r])
      row.deviation.emplace_back();
    else if (difference)
      row.deviation.push_back(values[r]);
    else if (one && *one != 0)
      row.deviation.push_back((*values[r] - *one) / std::abs(*one));
    else
      row.deviation.emplace_back();
  }
  return row;
}

}  // namespace

Comparison compare_records(const std::vector<Record>& records, const std::string& quantity,
                           const ComparisonSpan& span) {
  Comparison result = common_span(records, quantity, span);
  const double from = result.from, to = result.to;
  std::vector<Curve> part;
  for (const Record& r : records) {
    part.push_back(clip(r.curve, from, to));
    result.origin.push_back(result.after_contact ? *r.contact : from);
    result.points = std::max(result.points, part.back().size());
  }
  result.points = std::clamp<std::size_t>(result.points, 2, most_points);

  const auto peak_of = [&](std::size_t r, bool first_one) {
    return first_one ? first_peak_in_span(records[r], result.origin[r], from, to)
                     : peak_in_span(records[r], from, to);
  };
  const auto value_of = [&](const std::string& name, std::size_t r) -> std::optional<double> {
    if (name == "impulse") return impulse_of(records[r], from, to);
    if (name == "mean") return impulse_of(records[r], from, to) / (to - from);
    if (name == "rms") return rms(part[r], from, to);
    if (name == "final") return part[r].value.back();
    if (name == "frequency") return clear_frequency(part[r], from, to);
    if (name == "l2" || name == "dtw") {
      if (r == 0) return std::nullopt;
      const double d = name == "l2" ? l2_difference(part[r], part[0])
                                    : time_warping(at_equal_steps(part[r], from, to, result.points),
                                                   at_equal_steps(part[0], from, to, result.points));
      return std::isfinite(d) ? std::optional(d) : std::nullopt;
    }
    const auto point = peak_of(r, name.ends_with("first_peak"));
    if (!point) return std::nullopt;
    if (!name.starts_with("time_of")) return point->value;
    return point->value != 0 ? std::optional(point->time - result.origin[r]) : std::nullopt;  // of zeros none
  };
  for (const std::string& name : record_metrics()) {
    std::vector<std::optional<double>> values;
    for (std::size_t r = 0; r < records.size(); ++r) values.push_back(value_of(name, r));
    result.rows.push_back(row_of(name, records.front().unit, values));
  }
  return result;
}

}  // namespace strake
