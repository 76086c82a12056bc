#include "fluid/ranks/halo.hpp"

namespace strake::fluid {

void pack(const std::byte* column, std::size_t each, std::span<const std::int32_t> list, Bytes& bytes) {
  bytes.resize(list.size() * each);
  std::byte* to = bytes.data();
  for (const std::int32_t i : list) {
    std::memcpy(to, column + static_cast<std::size_t>(i) * each, each);
    to += each;
  }
}

void unpack(const std::byte* from, std::size_t each, std::span<const std::int32_t> list, std::byte* column) {
  for (const std::int32_t i : list) {
    std::memcpy(column + static_cast<std::size_t>(i) * each, from, each);
    from += each;
  }
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
