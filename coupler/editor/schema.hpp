#pragma once

#include "proto/case/key_info.hpp"

#include <string>
#include <vector>

namespace strake {

/// Writes the JSON Schema (draft 7) of a case file, from the declarations of its keys.
///
/// An editor that knows it completes keys, shows their meaning and unit, and underlines what a run would
/// refuse. It sees one key at a time: types, bounds, choices, names, required keys. What several keys must
/// agree on, files, and `nan` it does not see. It refuses nothing that a run accepts.
std::string case_schema(const std::vector<KeyInfo>& keys);

}  // namespace strake
