#include "coupler/precice/config/quantities.hpp"

#include "proto/error.hpp"
#include "proto/text.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace strake {
namespace {

const std::array<Quantity, 5> known{{{"displacement", "m", 3, false},
                                     {"velocity", "m/s", 3, false},
                                     {"force", "N", 3, true},
                                     {"traction", "Pa", 3, false},
                                     {"pressure", "Pa", 1, false}}};

}  // namespace

QuantityNames::QuantityNames(const std::string& rules) {
  std::string_view left = rules;
  while (!left.empty()) {
    const std::string_view rule = left.substr(0, left.find(';'));
    left.remove_prefix(std::min(left.size(), rule.size() + 1));
    if (trimmed(rule).empty()) continue;
    const std::size_t equals = std::min(rule.find('='), rule.size());
    const std::string_view name = trimmed(rule.substr(0, equals));
    const std::string_view quantity = trimmed(rule.substr(std::min(equals + 1, rule.size())));
    if (name.empty() || quantity.empty())
      throw Error(ExitCode::command_line, "STRAKE_PRECICE_NAMES",
                  "has the rule \"" + std::string(rule) + "\"",
                  "Name=quantity, several with ; between them: Force=force;Displacement=displacement");
    rules_[std::string(name)] = quantity;
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
