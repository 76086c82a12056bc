#pragma once

#include "coupler/new_case/kinds.hpp"

#include <iosfwd>

namespace strake {

/// Asks for the kind of a case by its name. An empty line takes the first.
/// Throws Error(command_line) where the input ends before an answer.
const NewKind& ask_kind(std::istream& answers, std::ostream& questions);
/// Asks for the solver, the mesh file and each number of a kind, with their defaults and bounds. An answer
/// that does not do is asked for again. Throws Error(command_line) where the input ends.
NewAnswers ask_answers(const NewKind&, std::istream& answers, std::ostream& questions);

}  // namespace strake

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
