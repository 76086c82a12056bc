#include "coupler/new_case/questions.hpp"

#include "proto/error.hpp"
#include "proto/text.hpp"
#include "proto/visible.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <istream>
#include <ostream>

namespace strake {
namespace {

std::string answer_line(std::istream& answers) {
  std::string line;
  if (!std::getline(answers, line))
    throw Error(ExitCode::command_line, "strake new", "the input ended before all questions were answered",
                "give the answers as options: strake new --help");
  return std::string(trimmed(line));
}

double ask_number(const NewNumber& number, std::istream& answers, std::ostream& questions) {
  const std::string otherwise = number.follows.empty() ? fmt::format("{:g}", number.value) : number.follows;
  for (;;) {
    questions << fmt::format("{} [{}], {} (Enter: {}): ", number.name, number.unit, number.help, otherwise)
              << std::flush;
    const std::string line = answer_line(answers);
    if (line.empty()) return number.value;
    const std::optional<double> given = number_from<double>(line);
    const std::string problem = given ? out_of_bounds(number, *given) : "expected a number, such as 0.5";
    if (problem.empty()) return *given;
    questions << "  " << visible(line) << ": " << problem << "\n";
  }
}

std::string ask_choice(const std::string& question, const std::vector<std::string>& choices,
                       std::istream& answers, std::ostream& questions) {
  for (;;) {
    questions << fmt::format("{}: {} (Enter: {}): ", question, joined(choices, ", "), choices.front())
              << std::flush;
    const std::string line = answer_line(answers);
    if (line.empty()) return choices.front();
    for (const std::string& choice : choices)
      if (choice == line) return choice;
    questions << "  " << visible(line) << ": expected one of " << joined(choices, ", ") << "\n";
  }
}

}  // namespace

const NewKind& ask_kind(std::istream& answers, std::ostream& questions) {
  const std::vector<NewKind>& kinds = new_kinds();
  std::vector<std::string> names;
  for (const NewKind& kind : kinds) {
    names.push_back(kind.name);
    questions << fmt::format("  {:<9} {}\n", kind.name, kind.help);
  }
  const std::string name = ask_choice("kind of case", names, answers, questions);
  for (const NewKind& kind : kinds)
    if (kind.name == name) return kind;
  return kinds.front();
}

NewAnswers ask_answers(const NewKind& kind, std::istream& answers, std::ostream& questions) {
  NewAnswers given;
  while (kind.mesh && given.mesh.empty()) {
    questions << "mesh file: " << std::flush;
    given.mesh = answer_line(answers);
  }
  if (kind.mesh) given.up = ask_choice("axis of the file that points up", {"y", "z"}, answers, questions);
  if (kind.solvers.size() > 1)
    given.solver = ask_choice("solver of the body", kind.solvers, answers, questions);
  for (const NewNumber& number : kind.numbers)
    given.number[number.name] = ask_number(number, answers, questions);
  return given;
}

void add_new_options(CLI::App& command, NewOptions& options) {
  command.require_subcommand(0, 1);
  command.add_option("-o", options.out, "the case file, default KIND.toml")->type_name("FILE");
  for (const NewKind& kind : new_kinds()) {
    CLI::App* one = command.add_subcommand(kind.name, kind.help);
    one->add_option("-o", options.out, "the case file, default " + kind.name + ".toml")->type_name("FILE");
    if (kind.mesh)
      one->add_option("MESH,--mesh", options.answers.mesh,
                      "mesh file, needed once: by its name alone, or after --mesh")
          ->type_name("FILE");
    if (kind.mesh)
      one->add_option("--up", options.answers.up,
                      "axis of the file that points up, default y; it is turned so")
          ->check(CLI::IsMember(std::vector<std::string>{"y", "z"}))
          ->type_name("y|z");
    if (kind.solvers.size() > 1)
      one->add_option("--solver", options.answers.solver, "of the body, default " + kind.solvers.front())
          ->check(CLI::IsMember(kind.solvers))
          ->type_name(joined(kind.solvers, "|"));
    for (const NewNumber& number : kind.numbers)
      one->add_option_function<double>(
             "--" + number.name,
             [&options, name = number.name](double x) { options.answers.number[name] = x; },
             fmt::format("{}; {:g} to {:g}, default {}", number.help, number.min, number.max,
                         number.follows.empty() ? fmt::format("{:g}", number.value) : number.follows))
          ->type_name(number.unit);
    one->callback([&options, &kind] { options.kind = kind.name; });
  }
}

}  // namespace strake
