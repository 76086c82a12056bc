#include "coupler/editor/declarations.hpp"

#include "coupler/case/case_queries.hpp"
#include "coupler/participant/launch.hpp"
#include "proto/error.hpp"
#include "proto/visible.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace strake {

const std::vector<std::string>& solver_programs() {
  static const std::vector<std::string> programs = {"strake-fluid",           "strake-fluid-replay",
                                                    "strake-structure-fem",   "strake-structure-particle",
                                                    "strake-structure-rigid", "strake-structure-replay",
                                                    "strake-attachment-fmu"};
  return programs;
}

Declarations collect_declarations() {
  Declarations all;
  std::set<std::string> seen;
  const auto add = [&](const std::vector<KeyInfo>& keys) {
    for (const KeyInfo& key : keys)
      if (seen.insert(key.path).second) all.keys.push_back(key);
  };
  add(coupler_declarations());
  for (const std::string& program : solver_programs()) {
    try {
      const Captured answer = capture(find_program(program), {"--keys"});
      if (answer.exit_code != 0) throw Error(ExitCode::participant_lost, program, "does not answer --keys");
      add(keys_from_json(answer.out));
    } catch (const Error&) {
      all.missing.push_back(program);
    }
  }
  // Root keys, then [fluid], [structure], [coupling], [output], …; inside a table as declared.
  const auto rank = [](const KeyInfo& key) {
    const std::string top = key.path.substr(0, key.path.find_first_of(".["));
    const std::vector<std::string> order = {"fluid",    "structure", "structures", "attachments",
                                            "coupling", "output",    "compare",    "run"};
    if (key.path.find('.') == std::string::npos && key.type != "table") return std::ptrdiff_t{-1};
    return std::find(order.begin(), order.end(), top) - order.begin();
  };
  std::stable_sort(all.keys.begin(), all.keys.end(),
                   [&](const KeyInfo& a, const KeyInfo& b) { return rank(a) < rank(b); });
  return all;
}

std::string table_of(const std::string& path) {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

std::string type_text(const KeyInfo& key) {
  if (!key.choices.empty()) return joined(key.choices, " | ");
  return key.unit.empty() || key.unit == "1" ? key.type : fmt::format("{} [{}]", key.type, key.unit);
}

std::string sentence(std::string text) {
  if (text.find('.') >= text.find(' '))
    text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text.ends_with('.') ? text : text + ".";
}

}  // namespace strake
