#pragma once

#include "coupler/new_case/kinds.hpp"

namespace CLI {
class App;
}

namespace strake {

/// What the user gave `strake new`.
struct NewOptions {
  std::string kind;           // of NewKind; empty: it is asked for
  NewAnswers answers;         // where none is given on a terminal, all are asked for
  std::filesystem::path out;  // empty: <kind>.toml
};

/// Adds each kind as a subcommand of `command`, with an option for each of its numbers.
void add_new_options(CLI::App& command, NewOptions&);

}  // namespace strake
