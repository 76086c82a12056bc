#pragma once

#include "coupler/case/case_view.hpp"
#include "proto/files/json_file.hpp"

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

/// The most threads that one process of the case has on this machine.
int most_threads_of(const CaseView&);

/// What run.json says of a side: solver, program, threads of each process, and the number of ranks where
/// there are several. Threads are left out where the ranks divide the processors of machines that are not
/// known.
Json record_of(const CaseView&, const SideView&);

/// Says in the text of case.toml what each rank takes, where ranks divide the processors of their machine.
/// The key is then a comment: a run of that text divides again, and its ranks do not take turns.
void say_shares(CaseView&);

/// A line for each side whose ranks have more threads than this machine has processors. Empty where the ranks
/// may run on other machines: their own log says it then. processors: 0 stands for those of this machine.
std::vector<std::string> crowd_lines(const CaseView&, int processors = 0);

/// The most ranks of one side that a case asks for. Reads it anew. sets: --set strings.
int most_ranks_of(const std::filesystem::path& case_file, const std::vector<std::string>& sets);

}  // namespace strake
