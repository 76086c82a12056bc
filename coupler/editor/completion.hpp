#pragma once

#include "coupler/editor/command_line.hpp"
#include "proto/case/key_info.hpp"

#include <string>
#include <vector>

namespace strake {

/// Writes the completion of bash for programs: commands, options, choices, case files, run folders, and the
/// keys of a case file behind --set with the choices of their values.
std::string bash_completion(const std::vector<ProgramText>& programs, const std::vector<KeyInfo>& keys);

}  // namespace strake
