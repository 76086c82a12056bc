#pragma once

#include "coupler/editor/command_line.hpp"

#include <string>
#include <utility>
#include <vector>

namespace strake {

/// Writes the man pages of a program (section 1) from its command line. The program has one, each command
/// another. A page has its file name ("strake-run.1") and its text in the macros of man(7).
std::vector<std::pair<std::string, std::string>> man_pages(const ProgramText&);

}  // namespace strake
