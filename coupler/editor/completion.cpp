#include "coupler/editor/command_line.hpp"
#include "coupler/editor/completion_script.hpp"
#include "proto/version.hpp"
#include "proto/visible.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace strake {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string words(const std::vector<std::string>& list) {
  return joined(list, " ");
}

/// What the script completes a value by: words, or ":case", ":run", … for a kind of file.
std::string kind_of(const OptionText& option) {
  if (!option.choices.empty()) return words(option.choices);
  const std::string& value = option.value;
  if (value == "CASE") return ":case";
  if (value == "STUDY") return ":study";
  if (value == "RUN") return ":run";
  if (value == "DIR") return ":folder";
  if (value == "FILE") return ":file";
  if (value == "KEY=VALUE") return ":assignment";
  if (value == "KEY") return ":key";
  return ":none";
}

/// The arrays of the script, entry by entry. A command is named by its words: "strake new wedge".
struct Tables {
  std::string commands, options, values, operands;

  void add(const std::string& path, const CLI::App& app) {
    std::vector<std::string> names, options_here;
    for (const OptionText& option : options_of(app)) {
      if (option.operand) {
        operands += entry(path, kind_of(option));
        continue;
      }
      for (const std::string& name : option.names) {
        options_here.push_back(name);
        if (!option.value.empty()) values += entry(path + " " + name, kind_of(option));
      }
    }
    for (const CLI::App* command : commands_of(app)) {
      names.push_back(command->get_name());
      add(path + " " + command->get_name(), *command);
    }
    if (!names.empty()) commands += entry(path, words(names));
    options += entry(path, words(options_here));
  }

  static std::string entry(const std::string& key, const std::string& value) {
    return fmt::format("  [{}]={}\n", quoted(key), quoted(value));
  }
};

/// "output.probe[].name" → "output.probe[0].name", which can be given to --set.
std::string first_element(std::string path) {
  for (auto at = path.find("[]"); at != std::string::npos; at = path.find("[]", at)) path.insert(at + 1, "0");
  return path;
}

}  // namespace

std::string bash_completion(const std::vector<ProgramText>& programs, const std::vector<KeyInfo>& keys) {
  Tables tables;
  std::vector<std::string> names;
  for (const ProgramText& program : programs) {
    names.push_back(program.name);
    tables.add(program.name, *program.app);
  }
  std::string listed, choices;
  for (const KeyInfo& key : keys) {
    if (key.type != "table") listed += first_element(key.path) + "\n";
    if (key.type == "flag") choices += Tables::entry(first_element(key.path), "true false");
    if (!key.choices.empty() && key.choices.front().find(' ') == std::string::npos)
      choices += Tables::entry(first_element(key.path), words(key.choices));
  }
  std::string text = fmt::format(
      "# Completion of bash for strake {}. Made by `strake explain --completion bash`.\n", strake_version());
  const auto array = [&](const char* name, const std::string& entries) {
    text += fmt::format("declare -gA _strake_{}=(\n{})\n", name, entries);
  };
  array("commands", tables.commands);
  array("options", tables.options);
  array("values", tables.values);
  array("operands", tables.operands);
  array("choices", choices);
  text += "_strake_keys='" + listed + "'\n" + completion_script;
  return text + "complete -F _strake " + words(names) + "\n";
}

}  // namespace strake
