#pragma once

#include "fluid/particles/state.hpp"
#include "fluid/ranks/halo.hpp"

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace strake::fluid {

/// Bytes of one entry of a column.
template <class Column>
std::size_t bytes_of_entry(const Column& column) {
  using Entry = std::remove_cvref_t<decltype(*column.data())>;
  static_assert(std::is_trivially_copyable_v<Entry>);
  if constexpr (requires { column.rows(); })
    return sizeof(Entry) * (Column::ColsAtCompileTime == 1 ? 1 : static_cast<std::size_t>(column.rows()));
  else
    return sizeof(Entry);
}
template <class Column>
std::byte* first_byte(Column& column) {
  return reinterpret_cast<std::byte*>(column.data());
}
template <class Column>
const std::byte* first_byte(const Column& column) {
  return reinterpret_cast<const std::byte*>(column.data());
}

/// Appends the listed particles to a message, column after column.
template <int dim>
void pack_particles(const State<dim>&, std::span<const std::int32_t> list, Bytes&);
/// Puts them to the listed places of another state, and moves `from` behind them.
template <int dim>
void unpack_particles(const std::byte*& from, std::span<const std::int32_t> list, State<dim>&);
/// Bytes of one particle in such a message.
template <int dim>
std::size_t bytes_of_particle(const State<dim>&);

}  // namespace strake::fluid
