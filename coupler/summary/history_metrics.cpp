#include "coupler/summary/history_metrics.hpp"

#include "coupler/compare/record.hpp"

#include <Eigen/Geometry>

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
  return std::any_of(names.begin(), names.end(), [&](const char* name) { return column == name; }) ||
         std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const char* prefix) { return column.starts_with(prefix); });
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
    metrics["time_of_" + name] = point->time;
  };
  put("peak", peak(curve));
  metrics["final"] = curve.value.back();
  if (!contact) return metrics;
  put("first_peak", first_peak(curve, *contact));
  if (is_load(column) && curve.time.back() >= *contact + impulse_time)
    metrics["impulse"] = impulse(curve, *contact, *contact + impulse_time);
  return metrics;
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
