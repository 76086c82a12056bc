#pragma once

#include "proto/ranks/communicator.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace strake::fluid {

/// Copies the listed entries of a column, of so many bytes each, one behind the other.
void copy_entries(const std::byte* column, std::size_t each, std::span<const std::int32_t> list,
                  std::byte* to);
/// The same into a message of its own.
void pack(const std::byte* column, std::size_t each, std::span<const std::int32_t> list, Bytes& bytes);
/// Puts them to the listed entries of another column.
void unpack(const std::byte* from, std::size_t each, std::span<const std::int32_t> list, std::byte* column);

/// Entries of a column that other ranks have copies of, and copies of theirs. send[r]: own entries, in the
/// order in which receive[own rank] of rank r lists its copies.
class Halo {
 public:
  std::vector<std::vector<std::int32_t>> send, receive;

  void clear(int ranks) {
    send.assign(static_cast<std::size_t>(ranks), {});
    receive.assign(static_cast<std::size_t>(ranks), {});
  }
  /// Gives the copies the values of their owners. each: bytes of an entry.
  void update(Communicator&, std::byte* column, std::size_t each) const;
  template <class T>
  void update(Communicator& communicator, T* column) const {
    update(communicator, reinterpret_cast<std::byte*>(column), sizeof(T));
  }
  /// The same, of values that read(i, to) writes to a message and write(i, from) takes from one.
  template <class Read, class Write>
  void update(Communicator& communicator, std::size_t each, const Read& read, const Write& write) const {
    to_.resize(send.size());
    from_.resize(receive.size());
    for (std::size_t r = 0; r < send.size(); ++r) {
      to_[r].resize(send[r].size() * each);
      from_[r].resize(receive[r].size() * each);
      std::byte* to = to_[r].data();
      for (const std::int32_t i : send[r]) {
        read(i, to);
        to += each;
      }
    }
    communicator.exchange(to_, from_);
    for (std::size_t r = 0; r < from_.size(); ++r) {
      const std::byte* from = from_[r].data();
      for (const std::int32_t i : receive[r]) {
        write(i, from);
        from += each;
      }
    }
  }
  /// Adds the copies to the values of their owners, in the order of ranks.
  void add_back(Communicator&, float* column) const;

 private:
  mutable std::vector<Bytes> to_, from_;
};

}  // namespace strake::fluid
