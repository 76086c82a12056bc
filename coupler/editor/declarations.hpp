#pragma once

#include "proto/case/key_info.hpp"

#include <string>
#include <vector>

namespace strake {

/// The programs of Strake that solve one side and print their keys.
const std::vector<std::string>& solver_programs();

/// Every key of a case file, each once: those of the coupler, then those of the solvers.
struct Declarations {
  std::vector<KeyInfo> keys;
  std::vector<std::string> missing;  // solver programs that are not built
};

/// Asks the coupler and each solver program (`--keys`). Keys stand in the order of proto/CASE_FILE.md: those
/// of the root, [fluid], [structure], [coupling], [output], [[compare]], [run].
Declarations collect_declarations();

/// Gives "fluid.scheme" for "fluid.scheme.cfl", and an empty text for a key of the root.
std::string table_of(const std::string& path);

/// Says what a key takes, in words: "number [m]", "fem | particle | rigid".
std::string type_text(const KeyInfo& key);

/// Gives "How the programs run." for "how the programs run". A text that begins with a key keeps its first
/// letter.
std::string sentence(std::string text);

/// Writes the JSON Schema (draft 7) of a case file, from the declarations of its keys.
///
/// An editor that knows it completes keys, shows their meaning and unit, and underlines what a run would
/// refuse. It sees one key at a time: types, bounds, choices, names, required keys. What several keys must
/// agree on, files, and `nan` it does not see. It refuses nothing that a run accepts.
std::string case_schema(const std::vector<KeyInfo>& keys);

}  // namespace strake
