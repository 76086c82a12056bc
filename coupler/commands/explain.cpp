#include "coupler/commands/commands.hpp"
#include "coupler/console/console.hpp"
#include "coupler/editor/declarations.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string_view>

namespace strake {

namespace {

void print_key(const KeyInfo& key) {
  fmt::print("{}\n", key.path);
  if (!key.help.empty()) fmt::print("  {}\n", key.help);
  if (key.type == "table") return;
  fmt::print("  type     {}\n", type_text(key));
  if (!key.range.empty()) fmt::print("  range    {}\n", key.range);
  fmt::print("  default  {}\n", key.default_value.empty() ? "none" : key.default_value);
  if (!key.paper_value.empty()) fmt::print("  paper    {}   (with preset = \"paper\")\n", key.paper_value);
}

void print_list(const std::vector<KeyInfo>& keys) {
  std::size_t width = 0;
  for (const KeyInfo& key : keys)
    if (key.type != "table") width = std::max(width, key.path.size());
  for (const KeyInfo& key : keys)
    if (key.type != "table") fmt::print("{:<{}}  {}\n", key.path, width, key.help);
}

/// Escapes bars, which a cell of a Markdown table may not contain.
std::string cell(std::string text) {
  for (auto bar = text.find('|'); bar != std::string::npos; bar = text.find('|', bar + 2))
    text.replace(bar, 1, "\\|");
  return text;
}

std::string code(const std::string& text) {
  return text.empty() ? text : "`" + cell(text) + "`";
}

/// The keys table by table, as Markdown; a table stands before the tables inside it.
class Reference {
 public:
  explicit Reference(const std::vector<KeyInfo>& keys) {
    for (const KeyInfo& key : keys) {
      list(key.type == "table" ? key.path : table_of(key.path));
      if (key.type == "table")
        help_[key.path] = key.help;
      else
        inside_[table_of(key.path)].push_back(&key);
    }
  }

  void print(const std::string& table = {}) const {
    if (const auto keys = inside_.find(table); keys != inside_.end()) print_keys(table, keys->second);
    for (const std::string& child : tables_)
      if (!child.empty() && table_of(child) == table) print(child);
  }

 private:
  void list(const std::string& table) {
    if (std::find(tables_.begin(), tables_.end(), table) != tables_.end()) return;
    if (!table.empty()) list(table_of(table));
    tables_.push_back(table);
  }

  void print_keys(const std::string& table, const std::vector<const KeyInfo*>& keys) const {
    const bool array = table.ends_with("[]");
    const std::string name = array ? "`[[" + table.substr(0, table.size() - 2) + "]]`" : "`[" + table + "]`";
    fmt::print("### {}\n\n", table.empty() ? "Top of the file" : name);
    const std::string declared = array ? table.substr(0, table.size() - 2) : table;
    if (const auto help = help_.find(declared); help != help_.end() && !help->second.empty())
      fmt::print("{}\n\n", sentence(help->second));
    fmt::print(
        "| key | type, unit | range | default | paper | meaning |\n| --- | --- | --- | --- | --- | --- |\n");
    for (const KeyInfo* key : keys)
      fmt::print("| `{}` | {} | {} | {} | {} | {} |\n",
                 key->path.substr(table.empty() ? 0 : table.size() + 1), cell(type_text(*key)),
                 cell(key->range), key->default_value.empty() ? "none" : code(key->default_value),
                 code(key->paper_value), cell(key->help));
    fmt::print("\n");
  }

  std::vector<std::string> tables_;
  std::map<std::string, std::vector<const KeyInfo*>> inside_;
  std::map<std::string, std::string> help_;
};

std::vector<KeyInfo> below(const std::vector<KeyInfo>& keys, const std::string& prefix) {
  std::vector<KeyInfo> found;
  for (const KeyInfo& key : keys)
    if (key.path.starts_with(prefix + ".") || key.path.starts_with(prefix + "[].")) found.push_back(key);
  return found;
}

[[noreturn]] void refuse(const std::string& word, const std::vector<KeyInfo>& keys) {
  std::vector<std::string> names;
  for (const KeyInfo& key : keys) names.push_back(key.path);
  std::string near = did_you_mean(word, names);
  // The last part alone is often all that is remembered: "spacing" for "fluid.spacing".
  const auto last = [](const std::string& name) { return name.substr(name.rfind('.') + 1); };
  if (near.empty()) {
    std::vector<std::string> endings, same;
    for (const std::string& name : names) endings.push_back(last(name));
    std::string ending = last(word);
    if (std::find(endings.begin(), endings.end(), ending) == endings.end())
      ending = did_you_mean(ending, endings);
    for (const std::string& name : names)
      if (!ending.empty() && last(name) == ending) same.push_back(name);
    near = joined(same, ", ");
  }
  throw Error(ExitCode::command_line, "explain " + word, "there is no such key",
              near.empty() ? "`strake explain` lists every key" : "did you mean " + near + "?");
}

/// An error names a key by its place in a list, "attachments[0].at": it is attachments[].at.
std::string without_places(const std::string& key) {
  std::string declared;
  bool inside = false;  // of brackets
  for (const char c : key) {
    inside = c != ']' && (inside || c == '[');
    if (!inside || c == '[') declared += c;
  }
  constexpr std::string_view bodies = "structures[]";
  return declared.starts_with(bodies) ? "structure" + declared.substr(bodies.size()) : declared;
}

}  // namespace

ExitCode explain(const ExplainOptions& options) {
  const std::string key = without_places(options.key);
  const Declarations all = collect_declarations();
  if (options.schema) {
    put(stdout, case_schema(all.keys));
  } else if (options.markdown) {
    Reference(all.keys).print();
  } else if (key.empty()) {
    print_list(all.keys);
  } else {
    const auto named =
        std::find_if(all.keys.begin(), all.keys.end(), [&](const KeyInfo& info) { return info.path == key; });
    const std::vector<KeyInfo> inside = below(all.keys, key);
    if (named == all.keys.end() && inside.empty()) refuse(key, all.keys);
    if (named != all.keys.end()) print_key(*named);
    print_list(inside);
  }
  for (const std::string& program : all.missing)
    fmt::print(stderr, "{} is not here: keys that only it knows are left out\n", program);
  return ExitCode::done;
}

}  // namespace strake
