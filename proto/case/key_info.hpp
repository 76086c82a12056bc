#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace strake {

/// What a declaration accepts, for programs; KeyInfo::range says it in words.
struct KeyLimits {
  std::optional<double> min = {}, max = {};  // of a number, or of each component of a vector, box or point
  bool above = false;                        // min itself is refused
  bool infinite = false;                     // inf is accepted beside numbers up to max
  bool path = false;                         // a choice: the path of a program is accepted as well
  bool required = false;                     // a case without it is refused
  std::vector<std::string> unless = {};      // … if none of these keys of the same table is given either
  std::size_t fewest = 0, most = 0;          // points in a list; most = 0: any number
};

/// The data of one declaration: `explain`, the resolved echo and the reference are made from these.
struct KeyInfo {
  std::string path = {};  // "fluid.scheme.radius.density"; tables of an array: "output.probe[0].name",
                          // without a case file "output.probe[].name"
  std::string type = {};  // "number" | "integer" | "flag" | "text" | "choice" | "vector" | "box" | "points" |
                          // "table" | "file" | "folder" | "texts" | "scalars" | "not built" (refused by name)
  // Values are TOML (0.01, inf, true, [0, 1, 0]), except that one text stands without its quotes.
  std::string unit = {}, range = {}, default_value = {}, paper_value = {}, value = {};
  std::string origin = {};  // default | preset | case | --set
  std::string help = {};
  std::vector<std::string> choices = {};
  KeyLimits limits = {};
  std::string instead = {};  // not empty: an older name, which is still read, of this key of the same table
};

/// JSON array of declarations, as `strake-fluid --keys` prints it, and back.
std::string to_json(const std::vector<KeyInfo>&);
std::vector<KeyInfo> keys_from_json(const std::string&);

}  // namespace strake
