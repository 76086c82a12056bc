#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace strake::report {

// Members of JSON that a kill or another program may have left in any state. A member that is missing or of
// another kind is none.

/// null where `json` is no object or has no such member.
const nlohmann::ordered_json& member(const nlohmann::ordered_json& json, const std::string& key);
std::string string_of(const nlohmann::ordered_json& json, const std::string& key);
std::optional<double> number_of(const nlohmann::ordered_json& json, const std::string& key);

}  // namespace strake::report
