#pragma once

#include "coupler/case/case_view.hpp"
#include "coupler/compare/compare.hpp"

#include <vector>

namespace strake {

/// The compare blocks that apply to a case, evaluated during its run.
class ComparisonStatus {
 public:
  explicit ComparisonStatus(const CaseView&);
  /// What the blocks came to of which all metrics have become known since the last call.
  std::vector<Verdict> settle(const RunData& now);
  /// Every block as it stands.
  std::vector<Verdict> all(const RunData&) const;

 private:
  std::vector<CompareBlock> blocks_;
  std::vector<bool> settled_;  // of blocks_
};

}  // namespace strake
