#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

namespace strake::fluid {

/// Calls visit(name, member...) for each listed member of one object, or of several at once. list: a tuple of
/// pairs of a name and a pointer to a member.
template <class List, class Visit, class... Objects>
void for_each_member(const List& list, Visit&& visit, Objects&... objects) {
  const auto one = [&](const auto& named) { visit(named.first, objects.*(named.second)...); };
  std::apply([&](const auto&... named) { (one(named), ...); }, list);
}

/// Adds the sizes of the listed members. The sum is less than the size of the object where a member is
/// missing.
template <class Object, class... Values>
constexpr std::size_t listed_bytes(const std::tuple<std::pair<const char*, Values Object::*>...>&) {
  return (sizeof(Values) + ...);
}

}  // namespace strake::fluid
