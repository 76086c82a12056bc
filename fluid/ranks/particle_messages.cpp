#include "fluid/ranks/particle_messages.hpp"

namespace strake::fluid {

template <int dim>
void pack_particles(const State<dim>& state, std::span<const std::int32_t> list, Bytes& bytes) {
  if (list.empty()) return;
  const auto one = [&](const char*, const auto& column) {
    const std::size_t each = bytes_of_entry(column), before = bytes.size();
    bytes.resize(before + each * list.size());
    copy_entries(first_byte(column), each, list, bytes.data() + before);
  };
  for_each_column(one, state);
}

template <int dim>
void unpack_particles(const std::byte*& from, std::span<const std::int32_t> list, State<dim>& state) {
  const auto one = [&](const char*, auto& column) {
    unpack(from, bytes_of_entry(column), list, first_byte(column));
    from += bytes_of_entry(column) * list.size();
  };
  for_each_column(one, state);
}

template <int dim>
std::size_t bytes_of_particle(const State<dim>& state) {
  std::size_t bytes = 0;
  for_each_column([&](const char*, const auto& column) { bytes += bytes_of_entry(column); }, state);
  return bytes;
}

template void pack_particles<2>(const State<2>&, std::span<const std::int32_t>, Bytes&);
template void pack_particles<3>(const State<3>&, std::span<const std::int32_t>, Bytes&);
template void unpack_particles<2>(const std::byte*&, std::span<const std::int32_t>, State<2>&);
template void unpack_particles<3>(const std::byte*&, std::span<const std::int32_t>, State<3>&);
template std::size_t bytes_of_particle<2>(const State<2>&);
template std::size_t bytes_of_particle<3>(const State<3>&);

}  // namespace strake::fluid
