#include "coupler/compare/record.hpp"

#include "proto/error.hpp"
#include "proto/files/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

namespace strake {
namespace {

namespace fs = std::filesystem;

struct Unit {
  const char* name;
  double factor;
  const char* si;
};
constexpr std::array<Unit, 26> units = {{{"ms", 1e-3, "s"},
                                         {"us", 1e-6, "s"},
                                         {"µs", 1e-6, "s"},
                                         {"sec", 1, "s"},
                                         {"mm", 1e-3, "m"},
                                         {"cm", 1e-2, "m"},
                                         {"um", 1e-6, "m"},
                                         {"in", 0.0254, "m"},
                                         {"ft", 0.3048, "m"},
                                         {"kPa", 1e3, "Pa"},
                                         {"MPa", 1e6, "Pa"},
                                         {"GPa", 1e9, "Pa"},
                                         {"bar", 1e5, "Pa"},
                                         {"N/mm^2", 1e6, "Pa"},
                                         {"psi", 6894.757293168, "Pa"},
                                         {"kN", 1e3, "N"},
                                         {"MN", 1e6, "N"},
                                         {"lbf", 4.4482216152605, "N"},
                                         {"kN/m", 1e3, "N/m"},
                                         {"MN/m", 1e6, "N/m"},
                                         {"mm/s", 1e-3, "m/s"},
                                         {"km/h", 1 / 3.6, "m/s"},
                                         {"kn", 1852.0 / 3600, "m/s"},
                                         {"%", 1e-2, "1"},
                                         {"deg", std::numbers::pi / 180, "rad"},
                                         {"ft/s", 0.3048, "m/s"}}};

/// The earliest contact that run.json names.
std::optional<double> contact_of(const fs::path& run) {
  std::optional<double> earliest;
  const Json record = read_json(run / "run.json");
  for (const auto& [probe, time] : member(record, "contact").items())
    if (time.is_number() && (!earliest || time.get<double>() < *earliest)) earliest = time.get<double>();
  return earliest;
}

/// Whether a column says where a rigid body or a frame of supports is, what it does and what acts on it, or
/// is an account that one of several bodies keeps.
bool tells_of_place(const std::string& column) {
  const auto dot = column.find('.');
  const std::string own = dot == std::string::npos ? "" : column.substr(dot + 1);  // of one of several bodies
  return column.starts_with("body.") || column.starts_with("support.") || own.starts_with("body.") ||
         own.starts_with("support.") || own.starts_with("energy.") || own.starts_with("failure.");
}

/// A peak of summary.json: value and time, where both are numbers.
std::optional<CurvePoint> told_peak(const Json& probe, const std::string& metric) {
  const auto value = number_of(probe, metric), time = number_of(probe, "time_of_" + metric);
  if (!value || !(time || *value == 0)) return std::nullopt;  // zeros have no time of their peak
  return CurvePoint{.time = time.value_or(0), .value = *value};
}

/// q_k with the largest |q| of value, least and most, row by row; the value alone where the rows differ.
Curve largest_of(const Curve& value, const Curve& least, const Curve& most) {
  Curve extremes = value;
  if (least.time != value.time || most.time != value.time) return extremes;
  for (std::size_t k = 0; k < value.size(); ++k)
    for (const double q : {least.value[k], most.value[k]})
      if (std::abs(q) > std::abs(extremes.value[k])) extremes.value[k] = q;
  return extremes;
}

std::size_t index_of(const Table& table, const std::string& name) {
  return static_cast<std::size_t>(&table.column(name) - table.value.data());
}

}  // namespace

Curve curve_of(const Table& table, const std::string& column) {
  Curve curve;
  const auto time = table.find("time"), value = table.find(column);
  if (!time || !value) return curve;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double t = table.value[*time][row], q = table.value[*value][row];
    if (!std::isfinite(t) || !std::isfinite(q)) continue;
    curve.time.push_back(t);
    curve.value.push_back(q);
  }
  return curve;
}

bool is_load(const std::string& column) {
  for (const std::string own : {"body.fx", "body.fy", "body.fz", "body.moment"})
    if (column == own || column.ends_with("." + own)) return true;
  const std::string vector = column.substr(0, column.rfind('.'));  // of several bodies "left.force"
  const std::string last = vector.substr(vector.rfind('.') + 1);
  return vector != column && (last == "force" || last == "moment");
}

bool is_moment(const std::string& column) {
  return column.starts_with("moment.") || column.find(".moment") != std::string::npos;
}

std::string vector_of(const std::string& column) {
  if (is_moment(column)) {
    const std::string of = column.substr(0, column.find("moment"));
    return of + (of.ends_with("body.") ? "f" : "force.");
  }
  for (const char* last : {".x", ".y", ".z", ".fx", ".fy", ".fz", ".vx", ".vy", ".vz"})
    if (column.ends_with(last)) return column.substr(0, column.size() - 1);
  return column;
}

SiUnit in_si(const std::string& unit) {
  for (const Unit& known : units)
    if (unit == known.name) return {known.factor, known.si};
  return {1, unit};
}

void Record::shift(double by) {
  for (Curve* c : {&curve, &means, &extremes})
    for (double& t : c->time) t += by;
  for (std::optional<CurvePoint>* point : {&first_peak, &peak})
    if (*point) (*point)->time += by;
  if (contact) *contact += by;
}

RecordSource::RecordSource(const std::string& operand) : name_(operand) {
  fs::path path = operand;
  std::error_code error;
  if (!fs::exists(path, error)) {
    const auto colon = operand.rfind(':');
    if (colon != std::string::npos && fs::exists(operand.substr(0, colon), error)) {
      path = operand.substr(0, colon);
      chosen_ = operand.substr(colon + 1);
    }
  }
  if (!fs::exists(path, error))
    throw Error(
        ExitCode::case_file, operand, "there is no such run folder or file",
        "name a run folder (runs/plate_entry) or a CSV file, with :COLUMN to choose one of its columns");
  is_run_ = fs::is_directory(path, error);
  if (is_run_ && !fs::exists(path / "history.csv", error))
    throw Error(ExitCode::case_file, operand, "holds no history.csv",
                "name the folder of a run that `strake run` has made, e.g. runs/plate_entry");
  table_ = read_table(is_run_ ? path / "history.csv" : path);
  if (is_run_) {
    contact_ = contact_of(path);
    const Json summary = read_json(path / "summary.json");
    for (const auto& [probe, entry] : member(summary, "probes").items())
      if (entry.is_object()) peaks_[probe] = {told_peak(entry, "first_peak"), told_peak(entry, "peak")};
  }
  if (table_.columns.size() < 2)
    throw Error(ExitCode::case_file, table_.path.string(), "has one column",
                "the first column holds the time, the others what was measured: time [s],uy [m]");
  if (!chosen_.empty()) index_of(table_, chosen_);
  if (!is_run_ && in_si(table_.columns[0].unit).unit != "s")
    throw Error(
        ExitCode::case_file, table_.path.string() + ":1",
        fmt::format("its first column ({}) is in \"{}\"", table_.columns[0].name, table_.columns[0].unit),
        "the first column holds the time in s, ms or us: time [ms]");
}

std::vector<std::string> RecordSource::quantities() const {
  if (!chosen_.empty()) return {chosen_};
  std::vector<std::string> names;
  for (const Column& column : table_.columns)
    if (column.name != "time" && column.name != "window" && &column != &table_.columns.front())
      names.push_back(column.name);
  return names;
}

std::vector<std::string> RecordSource::telling_quantities() const {
  std::vector<std::string> names = quantities();
  if (!chosen_.empty() || peaks_.empty()) return names;  // a file, or a run whose probes nobody has told yet
  std::vector<std::string> telling;
  for (const std::string& name : names)
    if ((is_load(name) || peaks_.contains(name)) && !tells_of_place(name)) telling.push_back(name);
  return telling;
}

std::string RecordSource::column_for(const std::string& quantity) const {
  if (!chosen_.empty()) return chosen_;
  if (!is_run_ && table_.columns.size() == 2) return table_.columns[1].name;
  return quantity;
}

bool RecordSource::has(const std::string& quantity) const {
  return table_.find(column_for(quantity)).has_value();
}

Record RecordSource::record(const std::string& quantity) const {
  const std::string column = column_for(quantity);
  const std::size_t at = index_of(table_, column), clock = is_run_ ? index_of(table_, "time") : 0;
  const SiUnit time = in_si(table_.columns[clock].unit), unit = in_si(table_.columns[at].unit);
  const auto curve = [&](std::size_t c) {
    Curve result;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      const double t = table_.value[clock][row] * time.factor, q = table_.value[c][row] * unit.factor;
      if (!std::isfinite(t) || !std::isfinite(q)) continue;
      if (result.size() > 0 && !(t > result.time.back()))
        throw Error(ExitCode::case_file, table_.path.string(),
                    fmt::format("its times do not ascend: {:.9g} s after {:.9g} s in row {}", t,
                                result.time.back(), row + 1),
                    "sort the rows by time and leave out repeated ones");
      result.time.push_back(t);
      result.value.push_back(q);
    }
    return result;
  };
  Record record = {.name = name_, .unit = unit.unit, .curve = curve(at), .means = {}, .contact = contact_};
  if (record.curve.size() < 2)
    throw Error(ExitCode::case_file, table_.path.string(),
                fmt::format("{} has {} values over time", column, record.curve.size()),
                "a comparison takes two rows at least: let the run go further, or choose another column");
  if (!is_run_) return record;
  if (const auto means = table_.find(column + ".mean"))
    record.means = curve(*means);
  else if (is_load(column))
    record.means = record.curve;  // a row has the mean of its window
  if (table_.find(column + ".min") && table_.find(column + ".max"))
    record.extremes = largest_of(record.curve, curve(index_of(table_, column + ".min")),
                                 curve(index_of(table_, column + ".max")));
  if (const auto found = peaks_.find(column); found != peaks_.end())
    std::tie(record.first_peak, record.peak) = found->second;
  return record;
}

}  // namespace strake
