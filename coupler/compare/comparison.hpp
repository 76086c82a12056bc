#pragma once

#include "coupler/compare/record.hpp"

#include <optional>
#include <string>
#include <vector>

namespace strake {

/// The same metric of the largest component, such as force.y beside force.x.
struct LargestComponent {
  std::string quantity;
  double value = 0;  // its size in the first record
};

/// One metric of several records of one quantity; the others are compared with the first record.
struct MetricRow {
  std::string name;  // first_peak, peak, impulse, mean, rms, frequency, final, l2, dtw …
  std::string unit;  // of `value`
  std::vector<std::optional<double>> value;  // by record; none where the record does not have it
  /// (value − first) / |first|, or / |beside|; l2 and dtw are deviations themselves. None for the first
  /// record.
  std::vector<std::optional<double>> deviation;
  /// Of a component whose first value is below a hundredth of this one: a deviation from it says nothing.
  std::optional<LargestComponent> beside = {};
};

/// What several records of one quantity have in common, and where they differ.
struct Comparison {
  std::vector<MetricRow> rows;
  double from = 0, to = 0;  // [s] the span that all of them cover
  /// [s] origin for times of peaks, by record: contact if every record has it, else `from`.
  std::vector<double> origin;
  bool after_contact = false;
  std::size_t points = 0;  // equal steps at which dtw pairs the records
};

struct ComparisonSpan {
  std::optional<double> from, to;  // [s]; none: as far as all records reach
};

/// Metrics over the span that all records cover. Values between samples are linear; l2 is taken at the
/// samples of both, dtw at equal steps (time warping costs the product of both lengths). Throws
/// Error(command_line) when the records share no span or their units differ.
Comparison compare_records(const std::vector<Record>&, const std::string& quantity, const ComparisonSpan&);

/// Finds the rows of components that are small in the first record: each row gets the largest component that
/// it is small beside, and its deviations are parts of that. Components share a name up to its last dot and
/// the unit.
void find_small_components(const std::vector<std::string>& quantities, std::vector<Comparison>&);

/// The deviation of record r in words: in % of the first value, or of the largest component (with a star).
/// "(1) small" where the first value is below a hundredth of this one.
std::string deviation_text(const MetricRow&, std::size_t record);

/// What the stars and words of these rows mean, a line each; empty: there are none.
std::vector<std::string> deviation_notes(const std::string& quantity, const Comparison&);

/// Unit of a metric of a quantity in `unit`. "impulse" of "Pa" is in "Pa s", "l2" of anything in "1".
std::string metric_unit(const std::string& metric, const std::string& unit);

/// Whether a metric is a value of the curve itself, and so a line across its plot.
bool is_value_of_curve(const std::string& metric);

/// The metrics that `compare_records` gives.
const std::vector<std::string>& record_metrics();

/// Shift of a record's times so that it matches the first record. how: "0.0012" in s, "contact" (both met
/// water), or "peak" (its first peak). Throws Error(command_line).
double shift_onto(const Record& first, const Record& other, const std::string& how);

}  // namespace strake
