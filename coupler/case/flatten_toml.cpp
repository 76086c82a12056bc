#include "coupler/case/case_view.hpp"
#include "proto/case/case_depth.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

namespace strake {

namespace {

std::string text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node.as_array()) {
    std::string text = "[";
    for (const auto& item : *array) text += (text.size() > 1 ? ", " : "") + text_of(item);
    return text + "]";
  }
  return {};
}

void flatten(const toml::table& table, const std::string& prefix, std::map<std::string, std::string>& value) {
  for (const auto& [key, node] : table) {
    const bool named = prefix.empty() && (key.str() == "structures" || key.str() == "attachments");
    if (named && node.is_array_of_tables()) {
      for (const toml::node& one : *node.as_array()) {
        const toml::table& of = *one.as_table();
        flatten(of, fmt::format("{}.{}", key.str(), of["name"].value_or(std::string())), value);
      }
      continue;
    }
    const std::string path =
        prefix.empty() ? std::string(key.str()) : fmt::format("{}.{}", prefix, key.str());
    if (const auto* inner = node.as_table())
      flatten(*inner, path, value);
    else
      value[path] = text_of(node);
    if (node.is_array_of_tables())
      for (std::size_t k = 0; const toml::node& one : *node.as_array())
        flatten(*one.as_table(), fmt::format("{}[{}]", path, k++), value);
  }
}

/// The sections of a TOML text that the coupler answers for: those of the two sides come from their programs.

}  // namespace

std::map<std::string, std::string> flatten_toml(const std::string& text, const std::string& name) {
  require_shallow(text, name);
  try {
    std::map<std::string, std::string> value;
    flatten(toml::parse(text, name), {}, value);
    return value;
  } catch (const toml::parse_error& error) {
    throw Error(ExitCode::case_file,
                fmt::format("{}:{}:{}", name, error.source().begin.line, error.source().begin.column),
                "not TOML: " + std::string(error.description()),
                "a run writes this file itself: put its own one back, or run the case again");
  }
}

}  // namespace strake
