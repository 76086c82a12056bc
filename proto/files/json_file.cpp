#include "proto/files/json_file.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <sstream>

namespace strake {

std::optional<std::string> read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return stream ? std::optional(text.str()) : std::nullopt;
}

Json parse_json(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  return json.is_discarded() ? Json() : json;
}

Json read_json(const std::filesystem::path& path) {
  return parse_json(read_text(path).value_or(""));
}

std::string json_text(const Json& json, int indent, bool ascii) {
  return json.dump(indent, ' ', ascii, Json::error_handler_t::replace);
}

const Json& member(const Json& json, const std::string& key) {
  static const Json null;
  if (!json.is_object()) return null;
  const auto found = json.find(key);
  return found == json.end() ? null : *found;
}

std::string string_of(const Json& json, const std::string& key) {
  const Json& value = member(json, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

std::optional<double> number_of(const Json& json, const std::string& key) {
  const Json& value = member(json, key);
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::optional<bool> flag_of(const Json& json, const std::string& key) {
  const Json& value = member(json, key);
  return value.is_boolean() ? std::optional(value.get<bool>()) : std::nullopt;
}

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json finite(const std::optional<double>& value) {
  return value ? finite(*value) : Json();
}

}  // namespace strake
