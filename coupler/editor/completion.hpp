#pragma once

#include "coupler/editor/command_line.hpp"
#include "proto/case/key_info.hpp"

#include <string>
#include <vector>

namespace strake {

/// Writes the completion of bash for programs. It knows commands, options, choices, case files and run
/// folders; behind --set also the keys of a case file with their choices.
std::string bash_completion(const std::vector<ProgramText>& programs, const std::vector<KeyInfo>& keys);

}  // namespace strake
