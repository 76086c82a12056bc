#pragma once

#include <string>
#include <vector>

namespace strake {

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
};

/// JSON array of declarations, as `strake-fluid --keys` prints it, and back.
std::string to_json(const std::vector<KeyInfo>&);
std::vector<KeyInfo> keys_from_json(const std::string&);

}  // namespace strake
