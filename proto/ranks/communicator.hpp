#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace strake {

/// A message between two ranks.
using Bytes = std::vector<std::byte>;

/// Appends the bytes of a value, or takes them back.
template <class T>
void append(Bytes& bytes, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* const from = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof(T));
}
template <class T>
T take(const std::byte*& at) {
  static_assert(std::is_trivially_copyable_v<T>);
  T value;
  std::memcpy(&value, at, sizeof(T));
  at += sizeof(T);
  return value;
}
/// Returns the values of a message that holds nothing else.
template <class T>
std::vector<T> values_of(const Bytes& bytes) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

/// Seconds of the processor that this thread or this process has taken.
inline double processor_time(clockid_t of) {
  timespec time{};
  clock_gettime(of, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The ranks that compute one participant together: processes, or threads in tests. All of them call the same
/// functions in the same order. Each call waits for the others.
class Communicator {
 public:
  /// What one rank has sent, and how long it has waited.
  struct Account {
    double seconds_together = 0;  // in calls in which all ranks take part
    double seconds_apart = 0;     // in messages between two
    double cpu = 0;               // time of the processor in both
    std::int64_t bytes = 0, messages = 0;
    std::int64_t together = 0;  // calls in which all ranks take part
  };

 private:
  template <class Do>
  auto timed(double& seconds, std::size_t bytes, Do&& todo) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu = processor_time(CLOCK_THREAD_CPUTIME_ID);
    auto result = todo();
    account_.cpu += processor_time(CLOCK_THREAD_CPUTIME_ID) - cpu;
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    account_.bytes += static_cast<std::int64_t>(bytes);
    account_.together += &seconds == &account_.seconds_together ? 1 : 0;
    return result;
  }
  Account account_;

 public:
  Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;
  virtual ~Communicator() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  const Account& account() const { return account_; }

  /// Returns what each rank gave, in the order of ranks, on all of them.
  std::vector<Bytes> gather(std::span<const std::byte> own) {
    return timed(account_.seconds_together, own.size(), [&] { return gather_all(own); });
  }
  /// Shows the first rank what each rank gave, one after the other.
  void show_first(std::span<const std::byte> own,
                  const std::function<void(std::span<const std::byte>)>& visit) {
    timed(account_.seconds_together, own.size(), [&] {
      pass_to_first(own, visit);
      return 0;
    });
  }
  /// Sends to[r] to each rank r, and receives from[r]. The sizes of `from` are those that will arrive. An
  /// empty message is not sent.
  void exchange(std::span<const Bytes> to, std::span<Bytes> from) {
    std::size_t sent = 0;
    for (const Bytes& bytes : to) {
      sent += bytes.size();
      account_.messages += bytes.empty() ? 0 : 1;
    }
    timed(account_.seconds_apart, sent, [&] {
      pass(to, from);
      return 0;
    });
  }
  /// The same where the receiver does not know the sizes.
  std::vector<Bytes> exchange_any(std::span<const Bytes> to) {
    std::vector<std::int64_t> lengths(to.size());
    for (std::size_t r = 0; r < to.size(); ++r) lengths[r] = std::ssize(to[r]);
    std::vector<Bytes> from(to.size());
    const auto own = static_cast<std::size_t>(rank());
    lengths = timed(account_.seconds_together, 8 * to.size(), [&] { return pass_lengths(lengths); });
    for (std::size_t r = 0; r < to.size(); ++r)
      if (r != own) from[r].resize(static_cast<std::size_t>(lengths[r]));
    exchange(to, from);
    from[own] = to[own];
    return from;
  }

  /// Returns the values of all ranks, in the order of ranks.
  template <class T>
  std::vector<T> all(const T& own) {
    static_assert(std::is_trivially_copyable_v<T>);
    const Bytes bytes = timed(account_.seconds_together, sizeof(T),
                              [&] { return gather_equal(std::as_bytes(std::span(&own, 1))); });
    if (bytes.size() != sizeof(T) * static_cast<std::size_t>(size()))
      throw std::logic_error("ranks call different functions");
    return values_of<T>(bytes);
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

 protected:
  virtual std::vector<Bytes> gather_all(std::span<const std::byte> own) = 0;
  virtual void pass_to_first(std::span<const std::byte> own,
                             const std::function<void(std::span<const std::byte>)>& visit) = 0;
  /// Messages of equal length, one behind the other.
  virtual Bytes gather_equal(std::span<const std::byte> own) = 0;
  virtual void pass(std::span<const Bytes> to, std::span<Bytes> from) = 0;
  /// Sends to[r] to each rank r, and returns what they send.
  virtual std::vector<std::int64_t> pass_lengths(std::span<const std::int64_t> to) = 0;
};

}  // namespace strake
