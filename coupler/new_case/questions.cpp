#include "coupler/new_case/questions.hpp"

#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <charconv>
#include <istream>
#include <ostream>

namespace strake {
namespace {

std::string answer_line(std::istream& answers) {
  std::string line;
  if (!std::getline(answers, line))
    throw Error(ExitCode::command_line, "strake new", "the input ended before all questions were answered",
                "give the answers as options: strake new --help");
  line.erase(0, line.find_first_not_of(" \t\r"));
  line.erase(line.find_last_not_of(" \t\r") + 1);
  return line;
}

std::optional<double> read_number(const std::string& text) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return x;
}

double ask_number(const NewNumber& number, std::istream& answers, std::ostream& questions) {
  const std::string otherwise = number.follows.empty() ? fmt::format("{:g}", number.value) : number.follows;
  for (;;) {
    questions << fmt::format("{} [{}], {} (Enter: {}): ", number.name, number.unit, number.help, otherwise)
              << std::flush;
    const std::string line = answer_line(answers);
    if (line.empty()) return number.value;
    const std::optional<double> given = read_number(line);
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

}  // namespace strake
