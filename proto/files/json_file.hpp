#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace strake {

/// JSON whose members keep their order.
using Json = nlohmann::ordered_json;

/// The bytes of a file; nothing where it cannot be read.
std::optional<std::string> read_text(const std::filesystem::path&);
/// null where the text is no JSON.
Json parse_json(const std::string& text);
/// null where the file cannot be read or is damaged.
Json read_json(const std::filesystem::path&);
/// indent: of each level; -1: all in one line. ascii: other characters are escaped. What is no UTF-8 is
/// replaced.
std::string json_text(const Json&, int indent = -1, bool ascii = false);

// Members of JSON that a kill or another program may have left in any state. A member that is missing or of
// another kind is none.

/// null where `json` is no object or has no such member.
const Json& member(const Json& json, const std::string& key);
std::string string_of(const Json& json, const std::string& key);
std::optional<double> number_of(const Json& json, const std::string& key);
std::optional<bool> flag_of(const Json& json, const std::string& key);
/// A number that is not finite is null.
Json finite(double);
Json finite(const std::optional<double>&);

}  // namespace strake
