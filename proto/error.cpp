#include "proto/error.hpp"

#include "proto/visible.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace strake {
namespace {

std::string text_of(const std::string& where, const std::string& problem, const std::string& fix) {
  std::istringstream lines(problem);
  std::string first, line;
  std::getline(lines, first);
  std::string text = where;
  if (!where.empty() && !first.empty()) text += ": ";
  text += first + "\n";
  // Details carry their own indentation when they show a line of the case file. Without a place all lines are
  // those of other errors.
  while (std::getline(lines, line))
    text += (line.starts_with(' ') || where.empty() ? line : "  " + line) + "\n";
  std::istringstream fixes(fix);
  const char* head = "  fix: ";
  while (std::getline(fixes, line)) {
    text += head + line + "\n";
    head = "       ";
  }
  return visible(text);
}

/// Edit distance in which an insertion, a deletion, a replacement and a swap of neighbours cost one each.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

Error::Error(ExitCode code, std::string where, std::string problem, std::string fix)
    : std::runtime_error(text_of(where, problem, fix)),
      code_(code),
      where_(std::move(where)),
      problem_(std::move(problem)),
      fix_(std::move(fix)) {}

std::string to_text(const Error& error) {
  return text_of(error.where(), error.problem(), error.fix());
}

Error all_of(const std::vector<Error>& errors) {
  if (errors.size() == 1) return errors.front();
  std::vector<std::string> blocks;
  for (const Error& error : errors) {
    std::istringstream lines(to_text(error));
    bool first = true;
    for (std::string line; std::getline(lines, line); first = false) {
      if (first || !line.starts_with(' '))
        blocks.push_back(line);
      else
        blocks.back() += "\n" + line;
    }
  }
  std::string text;
  // Two programs that read one key refuse it with the same words, and may differ in what mends it.
  const auto problem_of = [](const std::string& block) { return block.substr(0, block.find("\n  fix: ")); };
  std::vector<std::string> said;
  for (const std::string& block : blocks) {
    if (std::find(said.begin(), said.end(), problem_of(block)) != said.end()) continue;
    said.push_back(problem_of(block));
    text += (text.empty() ? "" : "\n") + block;
  }
  return {ExitCode::case_file, "", text};
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = 0;
  for (const std::string& name : known) {
    // One slip in three letters is still a slip; more is another word.
    const std::size_t allowed = std::max<std::size_t>(1, std::max(word.size(), name.size()) / 3);
    const std::size_t d = edit_distance(word, name);
    if (d <= allowed && d < std::min(word.size(), name.size()) && (nearest.empty() || d < least)) {
      nearest = name;
      least = d;
    }
  }
  return nearest;
}

}  // namespace strake
