#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

class CaseFile;

/// Returns the resolved value of a case key as text ("fem", "inf", "0.01", "[0, -6.26, 0]"). None if there is
/// no such key.
using CaseLookup = std::function<std::optional<std::string>(const std::string& key)>;

/// cases/VALIDATION.md, "Definitions": the impulse of a probe's own record runs over this time after contact
/// [s].
inline constexpr double impulse_window = 3.0e-4;

/// One [[compare]] table: what a case expects of itself.
struct CompareBlock {
  struct Metric {
    std::string name;  // one of `known_metrics`: first_peak, impulse, mean, slope, largest_deviation …
    double value = 0, tolerance = 0;  // tolerance: relative to |value|, absolute where value = 0
  };
  struct Span {
    std::string after = "start";  // "contact" | "start"
    double from = 0, to = 0;      // [s] after that; or its shares of the time up to the end of the run
    bool shares = false;
  };
  /// Units of a reference's two columns: time [s] = time_zero + time · first, quantity = value_zero + value ·
  /// second.
  struct Axes {
    double time = 1, time_zero = 0, value = 1, value_zero = 0;
  };
  std::string probe;                                     // "mid.y", "p_mid"
  std::map<std::string, std::vector<std::string>> when;  // key → values, any of which
  std::vector<Metric> metrics;
  std::optional<Span> window;
  std::string kind = "theory";  // theory | experiment | code | calibration
  std::string source;
  double divide_by = 1;        // what is measured is divided by it
  std::filesystem::path file;  // reference curve, absolute; empty: none
  std::string column;          // of the file; empty: its second
  Axes axes;
  std::string where;  // "case.toml:40:1: compare", for messages
};

/// Whether a window is the one over which a probe's own record has its impulse: 300 µs from contact on.
bool is_of_contact(const CompareBlock::Span&);

/// True if every condition of the block is met. Numbers compare as numbers (inf too), lists of numbers item
/// by item, the rest as text.
bool applies(const CompareBlock&, const CaseLookup&);

/// Declares and reads every [[compare]] table; a reference file is read and must be finite throughout.
/// Throws Error(case_file) with its place.
std::vector<CompareBlock> read_compare_blocks(CaseFile&);

}  // namespace strake
