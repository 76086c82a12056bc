// What was declared, as TOML and as JSON.
#include "proto/case/case_document.hpp"
#include "proto/files/json_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <memory>
#include <sstream>

namespace strake {
namespace {

/// The declared keys as the tree of tables that TOML wants: a table's own keys come before its sub-tables.
struct Branch {
  std::string name;  // a key, or for an element of an array its index
  const KeyInfo* key = nullptr;
  bool echoed = true;
  bool is_array = false;
  std::vector<std::unique_ptr<Branch>> below;

  Branch& child(const std::string& wanted) {
    for (const auto& branch : below)
      if (branch->name == wanted) return *branch;
    below.push_back(std::make_unique<Branch>());
    below.back()->name = wanted;
    return *below.back();
  }
};

bool is_text(const KeyInfo& key) {
  return key.type == "text" || key.type == "choice" || key.type == "file" || key.type == "folder";
}

std::string line_of(const Branch& branch) {
  const KeyInfo& key = *branch.key;
  const std::string value = is_text(key) ? to_toml(key.value) : key.value;
  const bool has_unit = !key.unit.empty() && key.unit != "1";
  const std::string note = (has_unit ? key.unit + ", " : "") + key.origin;
  if (!branch.echoed) return fmt::format("# {} is not given\n", quoted_key(branch.name));
  return fmt::format("{} = {}  # {}\n", quoted_key(branch.name), value, note);
}

void write(const Branch& branch, const std::string& path, bool is_element, std::string& text) {
  std::string own;
  for (const auto& child : branch.below)
    if (child->key) own += line_of(*child);
  if (!path.empty() && (is_element || !own.empty())) {
    if (!text.empty()) text += "\n";
    text += is_element ? "[[" + path + "]]\n" : "[" + path + "]\n";
  }
  text += own;
  for (const auto& child : branch.below) {
    if (child->key) continue;
    const std::string below = (path.empty() ? "" : path + ".") + quoted_key(child->name);
    if (child->is_array)
      for (const auto& element : child->below) write(*element, below, true, text);
    else
      write(*child, below, false, text);
  }
}

/// Replaces the paths that Strake itself reads in a table of a user's program (foreign_keys.cpp).
void make_absolute(toml::table& table, const std::filesystem::path& folder) {
  const auto replace = [&folder](toml::node* node, bool program) {
    toml::value<std::string>* text = node == nullptr ? nullptr : node->as_string();
    // A program without '/' may be a name on PATH.
    if (text == nullptr || text->get().empty() || (program && text->get().find('/') == std::string::npos))
      return;
    *text = (folder / text->get()).lexically_normal().string();
  };
  for (const char* key : {"folder", "surface", "config"}) replace(table.get(key), false);
  if (toml::array* command = table["command"].as_array(); command != nullptr && !command->empty())
    replace(command->get(0), true);
}

/// Replaces the texts of a user's program that name files beside the case. These are texts with a point or a
/// slash for which there is a file. Where there is none, only the program knows what the text is.
void make_files_absolute(toml::node& node, const std::filesystem::path& folder) {
  if (toml::table* table = node.as_table())
    for (auto&& [key, below] : *table) make_files_absolute(below, folder);
  if (toml::array* array = node.as_array())
    for (toml::node& below : *array) make_files_absolute(below, folder);
  toml::value<std::string>* text = node.as_string();
  if (text == nullptr || text->get().find_first_of("./") == std::string::npos) return;
  std::error_code none;
  if (const std::filesystem::path file = folder / text->get(); std::filesystem::is_regular_file(file, none))
    *text = file.lexically_normal().string();
}

/// The same in its table. A command line is relative to the folder where the program is started.
void make_own_files_absolute(toml::table& table, const std::filesystem::path& folder) {
  for (auto&& [key, below] : table)
    if (key != "solver" && key != "arguments" && key != "precice" && key != "precice_names")
      make_files_absolute(below, folder);
}

}  // namespace

std::string CaseFile::echo(const std::string& prefix) const {
  Branch root;
  for (std::size_t i = 0; i < document_->keys.size(); ++i) {
    const KeyInfo& key = document_->keys[i];
    if (key.type == "table" || key.type == "not built" || !lies_below(key.path, prefix)) continue;
    Branch* branch = &root;
    for (const PathStep& step : split_path(key.path)) {
      if (step.is_index) branch->is_array = true;
      branch = &branch->child(step.is_index ? fmt::format("{}", step.index) : step.key);
    }
    branch->key = &key;
    branch->echoed = document_->echoed[i];
  }
  std::string text;
  write(root, "", false, text);
  return document_->as_body(text);
}

std::string CaseFile::as_given(const std::string& table, const std::string& solver) const {
  const toml::table* given = document_->root[table].as_table();
  toml::table copy = given ? *given : toml::table();
  copy.insert_or_assign("solver", solver);
  make_absolute(copy, document_->folder());
  make_own_files_absolute(copy, document_->folder());
  if (toml::table* precice = copy["precice"].as_table()) make_absolute(*precice, document_->folder());
  const toml::table whole{{table, copy}};
  std::ostringstream text;
  text << toml::toml_formatter(whole) << "\n";
  return document_->as_body(text.str());
}

namespace {

/// What differs from KeyLimits{}; a limit that is infinite, which JSON has no number for, is left out.
Json json_of(const KeyLimits& limits) {
  Json json = Json::object();
  if (limits.min && std::isfinite(*limits.min)) json["min"] = *limits.min;
  if (limits.max && std::isfinite(*limits.max)) json["max"] = *limits.max;
  if (limits.above) json["above"] = true;
  if (limits.infinite) json["infinite"] = true;
  if (limits.path) json["path"] = true;
  if (limits.required) json["required"] = true;
  if (!limits.unless.empty()) json["unless"] = limits.unless;
  if (limits.fewest > 0) json["fewest"] = limits.fewest;
  if (limits.most > 0) json["most"] = limits.most;
  return json;
}

KeyLimits limits_of(const Json& json) {
  KeyLimits limits;
  if (json.contains("min")) limits.min = json.at("min").get<double>();
  if (json.contains("max")) limits.max = json.at("max").get<double>();
  limits.above = json.value("above", false);
  limits.infinite = json.value("infinite", false);
  limits.path = json.value("path", false);
  limits.required = json.value("required", false);
  limits.unless = json.value("unless", std::vector<std::string>());
  limits.fewest = json.value("fewest", std::size_t{0});
  limits.most = json.value("most", std::size_t{0});
  return limits;
}

}  // namespace

std::string to_json(const std::vector<KeyInfo>& keys) {
  Json list = Json::array();
  for (const KeyInfo& key : keys) {
    list.push_back({{"path", key.path},
                    {"type", key.type},
                    {"unit", key.unit},
                    {"range", key.range},
                    {"choices", key.choices},
                    {"default", key.default_value},
                    {"paper", key.paper_value},
                    {"value", key.value},
                    {"origin", key.origin},
                    {"help", key.help}});
    if (const Json limits = json_of(key.limits); !limits.empty()) list.back()["limits"] = limits;
    if (!key.instead.empty()) list.back()["instead"] = key.instead;
  }
  return json_text(list, 2) + "\n";
}

std::vector<KeyInfo> keys_from_json(const std::string& text) {
  std::vector<KeyInfo> keys;
  try {
    for (const Json& item : Json::parse(text)) {
      KeyInfo key;
      key.path = item.at("path");
      key.type = item.at("type");
      key.unit = item.value("unit", "");
      key.range = item.value("range", "");
      key.choices = item.value("choices", std::vector<std::string>());
      key.default_value = item.value("default", "");
      key.paper_value = item.value("paper", "");
      key.value = item.value("value", "");
      key.origin = item.value("origin", "");
      key.help = item.value("help", "");
      key.limits = limits_of(item.value("limits", Json::object()));
      key.instead = item.value("instead", "");
      keys.push_back(key);
    }
  } catch (const Json::exception& error) {
    throw Error(ExitCode::case_file, "list of keys",
                std::string("not the JSON that --keys prints\n") + error.what(),
                "run the solver with --keys by hand and look at what it prints");
  }
  return keys;
}

}  // namespace strake
