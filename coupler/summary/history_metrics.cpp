#include "coupler/summary/history_metrics.hpp"

#include "coupler/compare/record.hpp"
#include "proto/probe.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace strake {
namespace {

constexpr double impulse_time = 3.0e-4;  // [s] (cases/VALIDATION.md, "Definitions")

/// Whether a column counts or keeps accounts, and tells no result.
bool is_account(const std::string& column) {
  constexpr std::array names = {"window",   "time", "iterations",         "residual",
                                "work_gap", "cfl",  "pressure_iterations"};
  constexpr std::array prefixes = {"energy.", "water.", "failure.", "fluid.", "structure."};
  const auto dot = column.find('.');
  const std::string own = dot == std::string::npos ? "" : column.substr(dot + 1);  // of one of several bodies
  return std::any_of(names.begin(), names.end(), [&](const char* name) { return column == name; }) ||
         std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const char* prefix) { return column.starts_with(prefix); }) ||
         own.starts_with("energy.") || own.starts_with("failure.");
}

double median_of_size(std::vector<double> values) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A peak that stands alone.
struct Blow {
  CurvePoint peak;
  std::ptrdiff_t windows = 0;  // with half of it or more
  double times = 0;            // what is around it
};

std::optional<Blow> blow_of(const Curve& curve) {
  constexpr std::ptrdiff_t most_windows = 5, around = 20;
  constexpr double least_times = 3, contact = 0.01;  // of the peak; less before it: the body was in the air
  const std::vector<double>& f = curve.value;
  const auto size = std::ssize(f);
  if (size == 0) return std::nullopt;
  const auto largest =
      std::max_element(f.begin(), f.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  const double half = 0.5 * std::abs(*largest);
  std::ptrdiff_t first = largest - f.begin(), last = first + 1;
  while (first > 0 && std::abs(f[static_cast<std::size_t>(first - 1)]) >= half) --first;
  while (last < size && std::abs(f[static_cast<std::size_t>(last)]) >= half) ++last;
  const double before = median_of_size(
                   {f.begin() + std::max<std::ptrdiff_t>(0, first - around), f.begin() + first}),
               after = median_of_size({f.begin() + last, f.begin() + std::min(size, last + around)});
  const double rest = std::max(before, after);
  if (last - first > most_windows || before < contact * 2 * half || least_times * rest > 2 * half)
    return std::nullopt;
  return Blow{
      {curve.time[static_cast<std::size_t>(largest - f.begin())], *largest}, last - first, 2 * half / rest};
}

/// Largest |mean over 50 µs| after `contact` of a load, whose values are means since the row before. Longer
/// windows do not tell it.
std::optional<double> largest_mean(const Curve& means, double contact) {
  constexpr double longest = 50e-6 * (1 + 1e-9);  // [s] cases/VALIDATION.md, "Definitions"
  ProbeRecord record = ProbeRecord::waiting_for_contact();
  record.contact(contact);
  double before = 0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (means.time[k] > contact && means.time[k] - before > longest) return std::nullopt;
    record.add(before, means.time[k], means.value[k]);
    before = means.time[k];
  }
  return record.mean_peak_50us();
}

}  // namespace

std::vector<std::string> columns_without_record(const Table& history,
                                                const std::vector<std::string>& recorded) {
  std::vector<std::string> columns;
  for (const Column& column : history.columns) {
    const auto belongs = [&](const std::string& probe) {
      return column.name == probe || column.name.starts_with(probe + ".");
    };
    if (!is_account(column.name) && std::none_of(recorded.begin(), recorded.end(), belongs))
      columns.push_back(column.name);
  }
  return columns;
}

std::map<std::string, double> metrics_of_column(const Table& history, const std::string& column,
                                                std::optional<double> contact) {
  std::map<std::string, double> metrics;
  const Curve curve = curve_of(history, column);
  if (curve.size() == 0) return metrics;
  const auto put = [&](const std::string& name, const std::optional<CurvePoint>& point) {
    if (!point) return;
    metrics[name] = point->value;
    if (point->value != 0) metrics["time_of_" + name] = point->time;  // zeros have no peak
  };
  put("peak", peak(curve));
  metrics["final"] = curve.value.back();
  if (!contact) return metrics;
  put("first_peak", first_peak(curve, *contact));
  if (is_load(column) && curve.time.back() >= *contact + impulse_time)
    metrics["impulse"] = impulse_of_means(curve, *contact, *contact + impulse_time);
  if (const auto mean = is_load(column) ? largest_mean(curve, *contact) : std::nullopt)
    metrics["mean_peak_50us"] = *mean;
  return metrics;
}

std::vector<std::string> blow_lines(const Table& history, const std::vector<std::string>& columns) {
  std::map<std::string, std::pair<double, std::string>> largest;  // of each body: peak, column
  for (const std::string& column : columns) {
    const auto dot = column.rfind("force.");
    if (!is_load(column) || dot == std::string::npos) continue;
    // A body of several keeps an account of its energy, an attachment does not.
    if (dot > 0 && !history.find(column.substr(0, dot) + "energy.kinetic")) continue;
    const auto found = peak(curve_of(history, column));
    auto& [value, name] = largest[column.substr(0, dot)];
    if (found && std::abs(found->value) > value) {
      value = std::abs(found->value);
      name = column;
    }
  }
  if (largest.size() > 1) largest.erase("");  // the sum over several bodies
  std::vector<std::string> lines;
  for (const auto& [body, load] : largest)
    if (const auto blow = load.second.empty() ? std::nullopt : blow_of(curve_of(history, load.second)))
      lines.push_back(
          fmt::format("{}: the peak of {:.3g} {} at {:.4g} s lasts {} window{} and is {:.0f} times the force "
                      "around it. Steps and "
                      "spacing do not resolve it; impulses and means over more windows count",
                      load.second, blow->peak.value, history.columns[*history.find(load.second)].unit,
                      blow->peak.time, blow->windows, blow->windows == 1 ? "" : "s", blow->times));
  return lines;
}

Eigen::Vector3d moment_about_middle(const Points& position, const Eigen::Ref<const Points>& displacement,
                                    const Eigen::Ref<const Points>& force) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  if (position.cols() == 0 || displacement.cols() != position.cols() || force.cols() != position.cols())
    return moment;
  const Eigen::Vector3d middle =
      0.5 * (position.rowwise().minCoeff() + position.rowwise().maxCoeff()) + displacement.rowwise().mean();
  for (Eigen::Index i = 0; i < position.cols(); ++i) {
    const Eigen::Vector3d arm = position.col(i) + displacement.col(i) - middle, f = force.col(i);
    moment += arm.cross(f);
  }
  return moment;
}

}  // namespace strake
