#pragma once

#include "proto/case/key_info.hpp"

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace strake {

/// An option or operand of a command, as its declaration has it.
struct OptionText {
  std::vector<std::string> names;    // "-o", "--out"; of an operand its name: "CASE"
  std::string value;                 // name of its value, "KEY=VALUE"; empty: a flag
  std::vector<std::string> choices;  // values to choose from; empty: any
  std::string help, default_value;
  bool operand = false, required = false, many = false;
};

/// The options of a command in the order of their declarations, those of option groups too.
std::vector<OptionText> options_of(const CLI::App&);
/// The commands of a program, or the kinds of `strake new`.
std::vector<const CLI::App*> commands_of(const CLI::App&);

/// A program of Strake with its command line.
struct ProgramText {
  std::string name;  // "strake-fluid"
  const CLI::App* app = nullptr;
};

/// Writes the completion of bash for programs. It knows commands, options, choices, case files and run
/// folders; behind --set also the keys of a case file with their choices.
std::string bash_completion(const std::vector<ProgramText>& programs, const std::vector<KeyInfo>& keys);

/// Writes the man pages of a program (section 1) from its command line. The program has one, each command
/// another. A page has its file name ("strake-run.1") and its text in the macros of man(7).
std::vector<std::pair<std::string, std::string>> man_pages(const ProgramText&);

}  // namespace strake
