#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

namespace strake::fluid {

/// Calls visit(name, member...) for each listed member of one object, or of several side by side. list: a
/// tuple of pairs of a name and a pointer to a member.
template <class List, class Visit, class... Objects>
void for_each_member(const List& list, Visit&& visit, Objects&... objects) {
  const auto one = [&](const auto& named) { visit(named.first, objects.*(named.second)...); };
  std::apply([&](const auto&... named) { (one(named), ...); }, list);
}

/// Adds up the sizes of the listed members: less than the object has where one is missing.
template <class Object, class... Values>
constexpr std::size_t listed_bytes(const std::tuple<std::pair<const char*, Values Object::*>...>&) {
  return (sizeof(Values) + ...);
}

}  // namespace strake::fluid
