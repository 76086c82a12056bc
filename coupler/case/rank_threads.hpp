#pragma once

#include "coupler/case/case_view.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace strake {

/// The table of a side in the case: "fluid", "structure", "structures.left".
std::string table_of(const SideView&);

/// Number of ranks that compute a side; 1: it is one process.
int ranks_of(const CaseView&, const SideView&);

/// Threads of each process of a side, where all of them run on this machine.
int threads_of(const CaseView&, const SideView&);

/// A line for each side whose ranks have more threads than this machine has processors. Empty where the ranks
/// may run on other machines: their own log says it then. processors: 0 stands for those of this machine.
std::vector<std::string> crowd_lines(const CaseView&, int processors = 0);

/// The most ranks of one side that a case asks for. Reads it anew. sets: --set strings.
int most_ranks_of(const std::filesystem::path& case_file, const std::vector<std::string>& sets);

}  // namespace strake
