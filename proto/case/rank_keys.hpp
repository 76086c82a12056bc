#pragma once

#include "proto/case/case_file.hpp"

#include <string>

namespace strake {

/// Reads `ranks` and `launcher` of a part of the case. help: what its ranks are for.
void read_rank_keys(CaseTable& part, const std::string& help, int& ranks, std::string& launcher);

/// What is wrong with several ranks of a part.
struct RankRefusal {
  std::string alone;  // what one rank alone computes; empty: nothing
  std::string fix;
};

/// Refuses what one rank alone computes, and a launcher without a word. Of one rank nothing is refused.
void check_rank_keys(const CaseTable& part, int ranks, const std::string& launcher, const RankRefusal&);

}  // namespace strake
