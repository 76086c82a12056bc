#pragma once

#include "coupler/compare/compare_block.hpp"
#include "coupler/compare/curve.hpp"
#include "proto/files/history.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// What a run has shown so far.
struct RunData {
  std::map<std::string, double> monitor;  // "<probe>:first_peak" …, of the last window
  const Table* history = nullptr;         // history.csv as far as it goes; may be null
  double time = 0;                        // [s] reached
  bool finished = false;                  // the run has ended: peaks and final values are what they are
};

/// The judgement on one metric of one block.
struct Verdict {
  enum class Result { pass, fail, not_reached };
  std::string probe, metric;
  std::optional<double> value;  // measured
  double reference = 0, tolerance = 0;
  Result result = Result::not_reached;
  std::string kind, source;
  double deviation() const;  // of the value from the reference
  /// "pass  mid.y first_peak 0.00160, expected 0.001625: -1.5 % (within 15 %), theory: source".
  std::string line() const;
};

/// The reference curve of a block that names a file, in seconds and in the probe's unit.
Curve reference_curve(const CompareBlock&);

/// One verdict per metric of the block, in the block's order. `not_reached` while the data is not there.
std::vector<Verdict> judge(const CompareBlock&, const RunData&);
/// Verdicts of every block that applies to this case.
std::vector<Verdict> judge(const std::vector<CompareBlock>&, const RunData&, const CaseLookup&);

}  // namespace strake
