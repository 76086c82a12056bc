#include "coupler/editor/command_line.hpp"
#include "coupler/editor/declarations.hpp"
#include "proto/version.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace strake {
namespace {

/// Decodes one character of UTF-8 that begins at `at`; moves `at` behind it.
char32_t next_character(const std::string& text, std::size_t& at) {
  const auto byte = static_cast<unsigned char>(text[at++]);
  if (byte < 0x80) return byte;
  const int more = byte >= 0xf0 ? 3 : byte >= 0xe0 ? 2 : 1;
  auto code = static_cast<char32_t>(byte & (0x3f >> more));
  for (int k = 0; k < more && at < text.size(); ++k)
    code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  return code;
}

/// A text as roff prints it unchanged: a backslash, a dash, and letters beyond ASCII have names.
std::string roff(const std::string& text) {
  std::string out = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (std::size_t at = 0; at < text.size();) {
    const char32_t c = next_character(text, at);
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '"')
      out += "\\(dq";
    else if (c == '`' || c == '^' || c == '~')
      out += c == '`' ? "\\(ga" : c == '^' ? "\\(ha" : "\\(ti";
    else if (c == '\n')
      out += "\n.br\n";
    else if (c < 0x80)
      out += static_cast<char>(c);
    else
      out += fmt::format("\\[u{:04X}]", static_cast<unsigned>(c));
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string head(const std::string& page, const std::string& summary) {
  std::string title = page;
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  return fmt::format(".TH {} 1 \"{}\" \"Strake {}\" \"Strake\"\n.SH NAME\n{} \\- {}\n", roff(title),
                     build_date(), roff(strake_version()), roff(page), roff(summary));
}

std::string synopsis(const std::string& command, const CLI::App& app) {
  std::string text = ".SH SYNOPSIS\n" + bold(command) + " [" + italic("OPTIONS") + "]";
  for (const OptionText& option : options_of(app)) {
    if (!option.operand) {
      if (option.required) text += " " + bold(option.names.back()) + " " + italic(option.value);
      continue;
    }
    const std::string name = italic(option.names.front()) + (option.many ? "..." : "");
    text += option.required ? " " + name : " [" + name + "]";
  }
  if (!commands_of(app).empty())
    text += " " + italic(app.get_parent() == nullptr ? "COMMAND" : "KIND") + " ...";
  return text + "\n";
}

/// "the case file, default x.toml" → "The case file, default x.toml."
std::string option_entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + (option.operand ? italic(name) : bold(name));
  if (!option.operand && !option.value.empty()) names += " " + italic(option.value);
  std::string help = option.help.empty() ? "" : sentence(option.help);
  if (!option.default_value.empty()) help += " Default: " + option.default_value + ".";
  if (option.required && !option.operand) help += " Required.";
  return ".TP\n" + names + "\n" + roff(help) + "\n";
}

std::string option_entries(const CLI::App& app) {
  std::string operands, options;
  for (const OptionText& option : options_of(app))
    (option.operand ? operands : options) += option_entry(option);
  return (operands.empty() ? "" : ".SH OPERANDS\n" + operands) + ".SH OPTIONS\n" + options;
}

/// The table of proto/README.md, which a test compares.
std::string exit_codes() {
  static const std::pair<const char*, const char*> meanings[] = {
      {"0", "done; under `run` also when a compare block fails or an alarm was raised"},
      {"1", "outside tolerance (`compare`, `run --strict`), or an alarm was raised (`run --strict`)"},
      {"2", "command line, or a run folder that exists already"},
      {"3", "the case file, or a file it names"},
      {"4", "a solver gave up, or a value is not finite"},
      {"5", "a participant crashed, froze or vanished; for a solver: its coupler did"},
      {"6", "cannot write"},
      {"70", "a mistake of Strake"},
      {"129, 130, 143", "ended by SIGHUP (the terminal has closed), SIGINT, SIGTERM"},
      {"141", "a command other than `run` whose output pipe was closed"}};
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : meanings) text += fmt::format(".TP\n{}\n{}\n", code, roff(meaning));
  return text;
}

std::string see_also(const std::vector<std::string>& pages) {
  std::string text;
  for (const std::string& page : pages) text += (text.empty() ? "" : ",\n") + (".BR " + roff(page) + " (1)");
  return ".SH SEE ALSO\n" + text + "\n";
}

/// The kinds of `strake new`: what each option is for depends on the kind.
std::string kinds_section(const CLI::App& command) {
  std::string text;
  for (const CLI::App* kind : commands_of(command)) {
    text += ".SS " + roff(command.get_name() + " " + kind->get_name()) + "\n" +
            roff(sentence(kind->get_description())) + "\n";
    for (const OptionText& option : options_of(*kind))
      if (option.names.back() != "--help") text += option_entry(option);
  }
  return text.empty() ? text : ".SH KINDS\n" + text;
}

std::string command_page(const std::string& program, const CLI::App& command) {
  return head(program + "-" + command.get_name(), command.get_description()) +
         synopsis(program + " " + command.get_name(), command) + ".SH DESCRIPTION\n" +
         roff(sentence(command.get_description())) + "\n" + option_entries(command) + kinds_section(command) +
         see_also({program});
}

}  // namespace

std::vector<std::pair<std::string, std::string>> man_pages(const ProgramText& program) {
  const CLI::App& app = *program.app;
  const std::vector<const CLI::App*> commands = commands_of(app);
  std::vector<std::pair<std::string, std::string>> pages;
  std::string text =
      head(program.name, commands.empty() ? "solver program of Strake" : app.get_description()) +
      synopsis(program.name, app) + ".SH DESCRIPTION\n" + roff(sentence(app.get_description())) + "\n";
  std::vector<std::string> others;
  if (!commands.empty()) text += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    text += ".TP\n" + bold(command->get_name()) + "\n" + roff(sentence(command->get_description())) + "\n";
    others.push_back(program.name + "-" + command->get_name());
    pages.emplace_back(others.back() + ".1", command_page(program.name, *command));
  }
  if (commands.empty()) others = {"strake", "strake-run"};
  text += option_entries(app) + exit_codes() + see_also(others);
  pages.insert(pages.begin(), {program.name + ".1", text});
  return pages;
}

}  // namespace strake
