#pragma once

#include "coupler/study/results.hpp"

#include <string>
#include <vector>

namespace strake::study {

/// A published sentence beside what was measured.
struct ClaimResult {
  std::string claim, source;
  std::string measured;  // the numbers that decide, in words
  std::string verdict;   // "holds" | "does not hold" | "cannot be judged"
  std::string why;
};

/// Each claim of the plan by its rule. A claim whose runs are missing cannot be judged, and says which are.
std::vector<ClaimResult> judge_claims(const Results&);

}  // namespace strake::study
