#include "proto/case/case_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace strake {
namespace {

bool is_bare(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

/// Reads `"a \"key\""` or `'a key'` from position i on; leaves i behind the closing quote.
bool read_quoted(const std::string& path, std::size_t& i, std::string& key) {
  const char quote = path[i++];
  for (; i < path.size() && path[i] != quote; ++i) {
    if (quote == '"' && path[i] == '\\' && i + 1 < path.size()) ++i;
    key += path[i];
  }
  return i < path.size() && path[i++] == quote;
}

constexpr std::size_t longest_value = 60;  // characters of a value that a message repeats

std::string shortened(const std::string& value) {
  return value.size() <= longest_value ? value : value.substr(0, longest_value) + " …";
}

}  // namespace

std::vector<PathStep> split_path(const std::string& path) {
  std::vector<PathStep> steps;
  std::size_t i = 0;
  while (i < path.size()) {
    PathStep step;
    if (path[i] == '[' && !steps.empty()) {
      const std::size_t end = path.find(']', i);
      if (end == std::string::npos) return {};
      const char *first = path.data() + i + 1, *last = path.data() + end;
      step.is_index = true;
      if (first != last && std::from_chars(first, last, step.index).ptr != last) return {};
      i = end + 1;
    } else {
      if (!steps.empty() && path[i++] != '.') return {};
      if (i >= path.size()) return {};
      if (path[i] == '"' || path[i] == '\'') {
        if (!read_quoted(path, i, step.key)) return {};
      } else {
        const std::size_t end = std::min(path.find_first_of(".[", i), path.size());
        step.key = path.substr(i, end - i);
        if (!is_bare(step.key)) return {};
        i = end;
      }
    }
    steps.push_back(step);
  }
  return steps;
}

std::string quoted_key(const std::string& key) {
  return is_bare(key) ? key : to_toml(key);
}

std::pair<std::string, std::string> parent_and_name(const std::string& path) {
  const std::vector<PathStep> steps = split_path(path);
  if (steps.empty() || steps.back().is_index) return {path, ""};
  const std::string& name = steps.back().key;
  const std::size_t length = quoted_key(name).size();
  return {steps.size() == 1 ? "" : path.substr(0, path.size() - length - 1), name};
}

bool lies_below(const std::string& path, const std::string& prefix) {
  if (prefix.empty() || path == prefix) return true;
  return path.starts_with(prefix) && (path[prefix.size()] == '.' || path[prefix.size()] == '[');
}

bool means(const std::string& key, const std::string& word) {
  static const std::map<std::string, std::vector<std::string>> other_names = {
      {"young", {"E", "e", "youngs_modulus", "young_modulus", "elastic_modulus", "modulus"}},
      {"poisson", {"nu", "poisson_ratio", "poissons_ratio"}},
      {"density", {"rho", "mass", "mass_density"}},
      {"kinematic_viscosity", {"nu", "viscosity"}},
      {"gravity", {"g"}},
      {"velocity", {"v", "speed"}},
      {"spacing", {"h", "dx", "l0", "particle_distance", "resolution"}},
      {"sound_speed", {"c", "c0", "speed_of_sound"}},
      {"thickness", {"t", "h"}},
      {"length", {"L", "l", "width"}},
      {"radius", {"r", "R"}},
      {"deadrise", {"angle", "beta"}},
      {"end_time", {"t_end", "tend", "end", "duration", "time"}},
      {"time_step", {"dt", "timestep", "step"}},
      {"window", {"dt", "time_step"}}};
  const auto names = other_names.find(key);
  return key == word || (names != other_names.end() &&
                         std::find(names->second.begin(), names->second.end(), word) != names->second.end());
}

std::string meant_key(const std::string& word, const std::vector<std::string>& known) {
  for (const std::string& key : known)
    if (means(key, word)) return key;
  return did_you_mean(word, known);
}

std::string to_toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[32];
  std::string text(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  if (const std::size_t e = text.find('e'); e != std::string::npos) {  // 2.1e+11 → 2.1e11, 1e-05 → 1e-5
    std::string exponent = text.substr(e + 1);
    const bool negative = exponent.starts_with('-');
    exponent.erase(0, exponent.find_first_not_of("+-0"));
    text = text.substr(0, e) + (negative ? "e-" : "e") + exponent;
  }
  return text;
}

std::string to_toml(const std::string& text) {
  constexpr std::string_view escaped = "\"\\\n\t\r", letters = "\"\\ntr";
  std::string quoted = "\"";
  for (const char c : text) {
    if (const std::size_t k = escaped.find(c); k != escaped.npos)
      quoted += {'\\', letters[k]};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      quoted += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    else
      quoted += c;
  }
  return quoted + "\"";
}

std::string to_toml(const toml::node& node) {
  if (const auto* v = node.as_string()) return to_toml(v->get());
  if (const auto* v = node.as_integer()) return fmt::format("{}", v->get());
  if (const auto* v = node.as_floating_point()) return to_toml(v->get());
  if (const auto* v = node.as_boolean()) return v->get() ? "true" : "false";
  std::string text;
  if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) text += (text.empty() ? "" : ", ") + to_toml(element);
    return "[" + text + "]";
  }
  if (const auto* table = node.as_table()) {
    for (auto&& [key, value] : *table)
      text += (text.empty() ? " " : ", ") + quoted_key(std::string(key.str())) + " = " + to_toml(value);
    return text.empty() ? "{}" : "{" + text + " }";
  }
  std::ostringstream date_or_time;
  if (const auto* v = node.as_date()) date_or_time << *v;
  if (const auto* v = node.as_time()) date_or_time << *v;
  if (const auto* v = node.as_date_time()) date_or_time << *v;
  return date_or_time.str();
}

CaseFile::Document::Found CaseFile::Document::find(const std::string& path) const {
  Found found{&root, nullptr};
  for (const PathStep& step : split_path(path)) {
    if (step.is_index) {
      const toml::array* array = found.node->as_array();
      if (!array || step.index < 0 || static_cast<std::size_t>(step.index) >= array->size()) return {};
      found = {array->get(static_cast<std::size_t>(step.index)), nullptr};
    } else {
      const toml::table* table = found.node->as_table();
      if (!table) return {};
      const auto entry = table->find(step.key);
      if (entry == table->end()) return {};
      found = {&entry->second, &entry->first};
    }
  }
  return found;
}

std::string CaseFile::Document::join(const std::string& table, const std::string& name) const {
  const std::string before = table.empty() ? "" : table + ".";
  const std::string as_one_key = before + quoted_key(name);
  if (at(as_one_key) || split_path(name).empty()) return as_one_key;
  return before + name;
}

const CaseFile::Document::Set* CaseFile::Document::set_of(const std::string& path) const {
  for (auto set = sets.rbegin(); set != sets.rend(); ++set)
    if (lies_below(path, set->path)) return &*set;
  // A table that only exists because a --set string needed it on its way.
  const toml::node* node = at(path);
  if (node && node->source().begin.line == 0)
    for (const Set& set : sets)
      if (lies_below(set.path, path)) return &set;
  return nullptr;
}

std::filesystem::path CaseFile::Document::folder() const {
  return std::filesystem::absolute(file).lexically_normal().parent_path();
}

std::string CaseFile::Document::place(const toml::source_position& at) const {
  return at.line == 0 ? name : fmt::format("{}:{}:{}", name, at.line, at.column);
}

std::string CaseFile::Document::excerpt(const toml::source_position& at, const std::string& remark) const {
  if (at.line == 0 || at.line > lines.size()) return "  " + remark;
  constexpr std::size_t widest = 100;  // characters of a line that are shown
  std::string shown, pad;
  std::size_t column = 0;  // characters, as the parser counts them
  for (const char c : lines[at.line - 1]) {
    const auto byte = static_cast<unsigned char>(c);
    const bool starts_character = (byte & 0xc0) != 0x80;
    if (starts_character && ++column < at.column) pad += c == '\t' ? '\t' : ' ';
    shown += byte < 0x20 && c != '\t' ? ' ' : c;
    if (column >= std::max<std::size_t>(widest, at.column) && starts_character && byte < 0x80) break;
  }
  while (++column < at.column) pad += ' ';
  return fmt::format("{:5} | {}\n      | {}^ {}", at.line, shown, pad, remark);
}

std::string CaseFile::Document::where(const std::string& path, const std::string& value) const {
  const Found found = find(path);
  std::string text = value;
  if (text.empty() && found.node) text = to_toml(*found.node);
  if (found.node) {
    if (const Set* set = set_of(path))
      return set->path == path
                 ? "--set " + set->argument
                 : fmt::format("--set {}: {} = {}", set->argument, shown(path), shortened(text));
    return fmt::format("{}: {} = {}", place(found.node->source().begin), shown(path), shortened(text));
  }
  if (const auto entry = index.find(path); entry != index.end()) {
    const KeyInfo& key = keys[entry->second];
    if (!key.value.empty()) return fmt::format("{}: {} = {} ({})", name, shown(path), key.value, key.origin);
  }
  return name + ": " + shown(path);
}

std::string CaseFile::Document::set_of_key(const std::string& path, const std::string& element) const {
  return fmt::format("--set {}.KEY=VALUE for a key of it{}", shown(element),
                     explained ? fmt::format("  (strake explain {})", path) : "");
}

Error CaseFile::Document::wrong(const std::string& path, const std::string& expected, const std::string& fix,
                                const toml::node* part) const {
  const toml::node* node = at(path);
  if (!node || set_of(path)) return {ExitCode::case_file, where(path), expected, fix};
  const toml::source_position& at = (part ? part : node)->source().begin;
  return {ExitCode::case_file, fmt::format("{}: {} = {}", place(at), shown(path), shortened(to_toml(*node))),
          "\n" + excerpt(at, expected), fix};
}

Error CaseFile::Document::missing(const std::string& path, const std::string& expected,
                                  const std::string& sample) const {
  const auto [parent, key] = parent_and_name(path);
  const toml::node* table = parent.empty() ? static_cast<const toml::node*>(&root) : at(parent);
  // A required key with a misspelt name is both missing and unknown. The error on the unknown key is more
  // helpful.
  for (auto&& [there, node] : table && table->is_table() ? *table->as_table() : toml::table()) {
    const std::string stranger = (parent.empty() ? "" : parent + ".") + quoted_key(std::string(there.str()));
    if (index.contains(stranger) || meant_key(std::string(there.str()), {key}).empty()) continue;
    const Set* set = set_of(stranger);
    return {ExitCode::case_file, set ? "--set " + set->argument : place(there.source().begin),
            shown(stranger) + " is not a key",
            fmt::format("did you mean {}?", key) +
                (explained && !parent.empty() ? fmt::format("  (strake explain {})", parent) : "")};
  }
  std::string fix = fmt::format("add {} = {}", quoted_key(key), sample);
  if (const std::size_t bracket = parent.rfind('['); parent.ends_with(']'))
    fix += " to this [[" + parent.substr(0, bracket) + "]]";
  else if (!parent.empty())
    fix += " to [" + in_file(parent) + "]" + (in_file(parent) == parent ? "" : " of " + body);
  if (parent == "structure.plate" && table == nullptr)  // nothing in the file speaks of a body
    fix += "; water alone: solver = \"none\" in [structure]; another shape: strake explain structure";
  if (table && !parent.empty() && table->source().begin.line > 0 && !set_of(parent))
    return {ExitCode::case_file, place(table->source().begin),
            shown(path) + " is missing\n" + excerpt(table->source().begin, expected), fix};
  if (parent.empty()) fix += " above the first [table]";
  return {ExitCode::case_file, name, shown(path) + " is missing\n" + expected, fix};
}

}  // namespace strake
