#include "coupler/editor/command_line.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>

namespace strake {
namespace {

std::vector<std::string> split_at(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

/// Words to choose from, where a value's name lists them: "fluid|structure". Of "S|contact|peak" the letter S
/// stands for a number.
std::vector<std::string> choices_in(const std::string& value) {
  if (value.find('|') == std::string::npos) return {};
  std::vector<std::string> choices = split_at(value, '|');
  std::erase_if(choices, [](const std::string& word) {
    return word.empty() || std::isupper(static_cast<unsigned char>(word.front())) != 0;
  });
  return choices;
}

OptionText text_of_option(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  text.operand = text.names.empty();
  if (text.operand) text.names = {option.get_name(true)};
  text.help = option.get_description();
  text.required = option.get_required();
  if (option.get_items_expected_max() == 0) return text;
  // Behind the colon stands what a check accepts.
  text.value = split_at(option.get_type_name(), ':').front();
  if (text.value == "TEXT" && text.operand) text.value = text.names.front();
  text.choices = choices_in(text.value);
  text.default_value = option.get_default_str();
  text.many = option.get_expected_max() > 1;
  return text;
}

const auto all = [](const CLI::App*) { return true; };

}  // namespace

std::vector<OptionText> options_of(const CLI::App& app) {
  std::vector<OptionText> texts;
  for (const CLI::Option* option : app.get_options()) {
    texts.push_back(text_of_option(*option));
    if (!option->get_positional() || !option->nonpositional()) continue;
    OptionText operand = texts.back();  // --case CASE, or CASE alone
    operand.operand = true;
    operand.names = {option->get_name(true)};
    texts.push_back(std::move(operand));
  }
  for (const CLI::App* group : app.get_subcommands(all))
    if (group->get_name().empty())
      for (OptionText& text : options_of(*group)) texts.push_back(std::move(text));
  return texts;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* command : app.get_subcommands(all))
    if (!command->get_name().empty()) commands.push_back(command);
  return commands;
}

}  // namespace strake
