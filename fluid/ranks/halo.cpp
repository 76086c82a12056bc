#include "fluid/ranks/halo.hpp"

namespace strake::fluid {

namespace {

/// Calls todo with the size of an entry, as a constant where it is a usual one: copies are then loads and
/// stores.
template <class Do>
void with_size(std::size_t each, Do&& todo) {
  if (each == 4) return todo(std::integral_constant<std::size_t, 4>());
  if (each == 8) return todo(std::integral_constant<std::size_t, 8>());
  if (each == 16) return todo(std::integral_constant<std::size_t, 16>());
  if (each == 24) return todo(std::integral_constant<std::size_t, 24>());
  todo(each);
}

}  // namespace

void copy_entries(const std::byte* column, std::size_t each, std::span<const std::int32_t> list,
                  std::byte* to) {
  with_size(each, [&](auto size) {
    for (const std::int32_t i : list) {
      std::memcpy(to, column + static_cast<std::size_t>(i) * size, size);
      to += size;
    }
  });
}

void pack(const std::byte* column, std::size_t each, std::span<const std::int32_t> list, Bytes& bytes) {
  bytes.resize(list.size() * each);
  copy_entries(column, each, list, bytes.data());
}

void unpack(const std::byte* from, std::size_t each, std::span<const std::int32_t> list, std::byte* column) {
  with_size(each, [&](auto size) {
    for (const std::int32_t i : list) {
      std::memcpy(column + static_cast<std::size_t>(i) * size, from, size);
      from += size;
    }
  });
}

void Halo::update(Communicator& communicator, std::byte* column, std::size_t each) const {
  to_.resize(send.size());
  from_.resize(receive.size());
  for (std::size_t r = 0; r < send.size(); ++r) {
    pack(column, each, send[r], to_[r]);
    from_[r].resize(receive[r].size() * each);
  }
  communicator.exchange(to_, from_);
  for (std::size_t r = 0; r < from_.size(); ++r) unpack(from_[r].data(), each, receive[r], column);
}

void Halo::add_back(Communicator& communicator, float* column) const {
  to_.resize(send.size());
  from_.resize(receive.size());
  for (std::size_t r = 0; r < send.size(); ++r) {
    pack(reinterpret_cast<const std::byte*>(column), sizeof(float), receive[r], to_[r]);
    from_[r].resize(send[r].size() * sizeof(float));
  }
  communicator.exchange(to_, from_);
  for (std::size_t r = 0; r < from_.size(); ++r) {
    const std::byte* at = from_[r].data();
    for (const std::int32_t i : send[r]) column[i] += take<float>(at);
  }
}

}  // namespace strake::fluid
