#pragma once

#include "coupler/compare/curve.hpp"
#include "proto/files/history.hpp"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace strake {

/// One quantity over time, in SI units, from a run or from another program or experiment.
struct Record {
  std::string name;     // where it comes from: "runs/plate_entry", "ansys.csv:uy"
  std::string unit;     // "m", "Pa", …
  Curve curve;          // lines of history.csv or of the file; those without a value are left out
  Curve means;          // mean since the line before, if the run recorded it ("p_mid.mean"); else empty
  Curve extremes = {};  // largest |q| since the line before, with its sign, if the run recorded it
  /// Peaks over all steps of a run's solver, as its summary.json has them.
  std::optional<CurvePoint> first_peak = {}, peak = {};
  std::optional<double> contact = {};  // [s], of a run that met water
  /// Moves it in time [s].
  void shift(double);
};

/// A run folder, or a CSV file. The header of the file has a name and a unit for each column, time first
/// ("time [ms],uy [mm]"). "FILE:COLUMN" chooses one column of it, whatever the quantity is called there.
class RecordSource {
 public:
  /// Throws Error(case_file) when it is neither, with what was expected.
  explicit RecordSource(const std::string& operand);
  const std::string& name() const { return name_; }
  bool is_run() const { return is_run_; }
  /// Its quantities over time: probes and columns of a run, columns of a file.
  std::vector<std::string> quantities() const;
  /// Those of its quantities that tell most: probes and forces of a run, all columns of a file.
  std::vector<std::string> telling_quantities() const;
  /// A file with one column beside the time, or with a chosen one, has that for every quantity.
  bool has(const std::string& quantity) const;
  /// Throws Error(case_file): no such column, an unknown unit of time, times that do not ascend, fewer than
  /// two values.
  Record record(const std::string& quantity) const;

 private:
  std::string column_for(const std::string& quantity) const;
  std::string name_, chosen_;
  bool is_run_ = false;
  Table table_;
  std::optional<double> contact_;
  std::map<std::string, std::pair<std::optional<CurvePoint>, std::optional<CurvePoint>>>
      peaks_;  // probe → first peak, peak; of summary.json
};

/// Whether a column of a run is a component of force or moment, the mean of its window. It is that on the
/// body ("force.y") or on one of several ("left.force.y"), as a rigid body tells it ("body.fy",
/// "body.moment"), or of an attachment ("mooring.force.y").
bool is_load(const std::string& column);
/// Whether a column is a moment, or a component of one.
bool is_moment(const std::string& column);
/// Returns the vector that a column is a component of: "force." of "force.x", "body.f" of "body.fx", else its
/// own name. A moment counts by its lever arm, in metres, beside the force.
std::string vector_of(const std::string& column);
/// A component with this share of the largest one of its vector is round-off: it has no peak of its own.
constexpr double round_off_share = 1e-6;
/// A column over "time" without the rows in which one of them is empty; empty where there is no such column.
Curve curve_of(const Table&, const std::string& column);

/// A unit as SI: {"kPa"} → {1000, "Pa"}. What is not known stays as it is.
struct SiUnit {
  double factor = 1;
  std::string unit;
};
SiUnit in_si(const std::string& unit);

}  // namespace strake
