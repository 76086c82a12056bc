#pragma once

#include "fluid/particles/state.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <type_traits>

namespace strake::fluid {

template <class Value>
auto bytes_of(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    return std::as_bytes(std::span(&value, 1));
  else
    return std::as_bytes(std::span(value.data(), static_cast<std::size_t>(value.size())));
}

/// Names of the members of State that differ in a bit, "" where none does.
template <int dim>
std::string differences(const State<dim>& a, const State<dim>& b) {
  std::string names;
  const auto compare = [&](const char* name, const auto& of_a, const auto& of_b) {
    if (!std::ranges::equal(bytes_of(of_a), bytes_of(of_b))) names += std::string(" ") + name;
  };
  for_each_column(compare, a, b);
  for_each_value(compare, a, b);
  return names;
}

}  // namespace strake::fluid
