#pragma once

#include <cstdint>

namespace strake {

/// A second descriptor of a connection that ZeroMQ owns. ZeroMQ reports the end of a connection in the same
/// words whether the other end closed it or fell silent for too long; the kernel knows which it was. While a
/// witness lives, the other end does not learn that ZeroMQ has closed its own descriptor.
class Witness {
 public:
  explicit Witness(int socket);
  ~Witness();
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

  /// Whether the other end has closed the connection, or its process has ended, which closes it too.
  bool closed_by_peer() const;
  /// Bytes that have come and that nobody has read.
  int unread() const;

 private:
  int socket_;
};

/// Bytes that the kernel has taken from the other end of a tcp connection; 0 where it cannot tell.
std::uint64_t bytes_received(int socket);

}  // namespace strake
