#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/case_file.hpp"

namespace strake {

/// The resolved value of a case key as text ("fem", "inf", "0.01", "[0, -6.26, 0]"); none when there is no
/// such key.
using CaseLookup = std::function<std::optional<std::string>(const std::string& key)>;

/// One [[compare]] table: what a case expects of itself.
struct CompareBlock {
  struct Metric {
    std::string name;  // first_peak, time_of_first_peak, peak, time_of_peak, impulse, mean_peak_50us, final,
                       // mean, rms
    double value = 0, tolerance = 0;  // tolerance: relative to |value|, absolute where value = 0
  };
  struct Span {
    std::string after = "start";  // "contact" | "start"
    double from = 0, to = 0;      // [s]
  };
  std::string probe;                                     // "mid.y", "p_mid"
  std::map<std::string, std::vector<std::string>> when;  // key → values, any of which
  std::vector<Metric> metrics;
  std::optional<Span> window;
  std::string kind = "theory";  // theory | experiment | code | calibration
  std::string source;
  std::filesystem::path file;  // reference curve, absolute; empty: none
  std::string where;           // "case.toml:40:1: compare", for messages
};

/// Declares and reads every [[compare]] table; a reference file is read and must be finite throughout.
/// Throws Error(case_file) with its place.
std::vector<CompareBlock> read_compare_blocks(CaseFile&);
/// True when every condition of the block holds: numbers compare as numbers (inf too), lists of numbers item
/// by item, the rest as text.
bool applies(const CompareBlock&, const CaseLookup&);

}  // namespace strake
