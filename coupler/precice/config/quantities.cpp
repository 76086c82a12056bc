#include "coupler/precice/config/quantities.hpp"

#include "proto/error.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace strake {
namespace {

const std::array<Quantity, 5> known{{{"displacement", "m", 3, false},
                                     {"velocity", "m/s", 3, false},
                                     {"force", "N", 3, true},
                                     {"traction", "Pa", 3, false},
                                     {"pressure", "Pa", 1, false}}};

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

QuantityNames::QuantityNames(const std::string& rules) {
  std::string_view left = rules;
  while (!left.empty()) {
    const std::string_view rule = left.substr(0, left.find(';'));
    left.remove_prefix(std::min(left.size(), rule.size() + 1));
    const std::size_t equals = rule.find('=');
    if (rule.empty()) continue;
    if (equals == 0 || equals == std::string_view::npos || equals + 1 == rule.size())
      throw Error(ExitCode::command_line, "STRAKE_PRECICE_NAMES",
                  "has the rule \"" + std::string(rule) + "\"",
                  "Name=quantity, several with ; between them: Force=force;Displacement=displacement");
    rules_[std::string(rule.substr(0, equals))] = rule.substr(equals + 1);
  }
}

Quantity QuantityNames::of(const std::string& name, bool conservative) const {
  const auto rule = rules_.find(name);
  const std::string wanted = rule == rules_.end() ? lower_case(name) : rule->second;
  for (const Quantity& quantity : known)
    if (quantity.name == wanted) return quantity;
  return {rule == rules_.end() ? name : wanted, "1", 0, conservative};
}

}  // namespace strake
