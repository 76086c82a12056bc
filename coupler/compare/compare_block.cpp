#include "coupler/compare/compare_block.hpp"

#include "proto/text.hpp"

#include <algorithm>
#include <cmath>

namespace strake {
namespace {

std::string_view unquoted(std::string_view text) {
  if (text.size() >= 2 && text.front() == text.back() && (text.front() == '"' || text.front() == '\''))
    return text.substr(1, text.size() - 2);
  return text;
}

std::optional<double> as_number(const std::string& text) {
  return number_from<double>(text.starts_with('+') ? text.substr(1) : text);
}

/// The items of "[a, b, c]"; none for anything else.
std::optional<std::vector<std::string>> as_list(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return std::nullopt;
  std::vector<std::string> items;
  std::string item;
  for (const char c : text.substr(1, text.size() - 2) + ",") {
    if (c != ',')
      item += c;
    else {
      if (!trimmed(item).empty()) items.emplace_back(trimmed(item));
      item.clear();
    }
  }
  return items;
}

bool equal(const std::string& first, const std::string& second) {
  const std::string a(trimmed(unquoted(trimmed(first)))), b(trimmed(unquoted(trimmed(second))));
  auto items_a = as_list(a), items_b = as_list(b);
  if (items_a && items_b) {
    // A plane vector [x, y] is [x, y, 0].
    auto& shorter = items_a->size() < items_b->size() ? *items_a : *items_b;
    const std::size_t longer = std::max(items_a->size(), items_b->size());
    if (longer == 3 && shorter.size() == 2) shorter.push_back("0");
    if (items_a->size() != items_b->size()) return false;
    for (std::size_t k = 0; k < longer; ++k)
      if (!equal((*items_a)[k], (*items_b)[k])) return false;
    return true;
  }
  const auto x = as_number(a), y = as_number(b);
  if (x && y) {
    constexpr double same = 1e-12;  // two ways of writing one number
    return *x == *y || (std::isfinite(*x) && std::isfinite(*y) &&
                        std::abs(*x - *y) <= same * std::max(std::abs(*x), std::abs(*y)));
  }
  return a == b;
}

}  // namespace

bool is_of_contact(const CompareBlock::Span& window) {
  constexpr double slack = 1e-9;
  return window.after == "contact" && !window.shares && window.from == 0 &&
         std::abs(window.to - impulse_window) <= slack * impulse_window;
}

bool applies(const CompareBlock& block, const CaseLookup& lookup) {
  return std::all_of(block.when.begin(), block.when.end(), [&](const auto& condition) {
    const std::optional<std::string> value = lookup(condition.first);
    return value && std::any_of(condition.second.begin(), condition.second.end(),
                                [&](const std::string& wanted) { return equal(*value, wanted); });
  });
}

}  // namespace strake
