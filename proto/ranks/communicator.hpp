#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace strake {

/// A message between two ranks.
using Bytes = std::vector<std::byte>;

/// The ranks that compute one participant together: processes, or threads in tests. All of them call the same
/// functions in the same order. Each call waits for the others.
class Communicator {
 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Returns what each rank gave, in the order of ranks, on all of them.
  virtual std::vector<Bytes> gather(std::span<const std::byte> own) = 0;
  /// Sends to[r] to each rank r, and receives from[r]. The sizes of `from` are those that will arrive. An
  /// empty message is not sent.
  virtual void exchange(std::span<const Bytes> to, std::span<Bytes> from) = 0;

  /// Returns the values of all ranks, in the order of ranks.
  template <class T>
  std::vector<T> all(const T& own) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values;
    for (const Bytes& bytes : gather(std::as_bytes(std::span(&own, 1)))) {
      if (bytes.size() != sizeof(T)) throw std::logic_error("ranks call different functions");
      std::memcpy(&values.emplace_back(), bytes.data(), sizeof(T));
    }
    return values;
  }
  /// Returns the largest value of all ranks.
  double max(double own) { return std::ranges::max(all(own)); }
  /// Returns the sum of all ranks, added in the order of ranks.
  template <class T>
  T sum(const T& own) {
    T total{};
    for (const T& value : all(own)) total += value;
    return total;
  }
  bool any(bool own) { return sum(std::int64_t{own ? 1 : 0}) > 0; }
};

}  // namespace strake
