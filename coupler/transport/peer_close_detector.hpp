#pragma once

#include <cstdint>

namespace strake {

/// A second descriptor of a connection that ZeroMQ owns. ZeroMQ does not distinguish whether the other end
/// closed a connection or was silent for too long; the kernel does. While a witness lives, the other end does
/// not learn that ZeroMQ has closed its own descriptor.
class PeerCloseDetector {
 public:
  explicit PeerCloseDetector(int socket);
  ~PeerCloseDetector();
  PeerCloseDetector(const PeerCloseDetector&) = delete;
  PeerCloseDetector& operator=(const PeerCloseDetector&) = delete;

  /// Whether the other end has closed the connection, or its process has ended, which closes it too.
  bool closed_by_peer() const;
  /// Bytes that have arrived and are unread.
  int unread() const;

 private:
  int socket_;
};

/// Bytes that the kernel has received from the other end of a tcp connection; 0 if unknown.
std::uint64_t bytes_received(int socket);

}  // namespace strake
