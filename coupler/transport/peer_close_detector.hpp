#pragma once

#include "proto/descriptor.hpp"

namespace strake {

/// A second descriptor of a connection that ZeroMQ owns. ZeroMQ does not distinguish whether the other end
/// closed a connection or was silent for too long; the kernel does. While a witness lives, the other end does
/// not learn that ZeroMQ has closed its own descriptor.
class PeerCloseDetector {
 public:
  explicit PeerCloseDetector(int socket);
  /// Whether the other end has closed the connection, or its process has ended, which closes it too.
  bool closed_by_peer() const;
  /// Bytes that have arrived and are unread.
  int unread() const;

 private:
  Descriptor socket_;
};

}  // namespace strake
