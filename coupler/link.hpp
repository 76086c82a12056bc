#pragma once

#include "proto/wire.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>

/// The transport. ZeroMQ stays inside link.cpp.
namespace strake {

/// The coupler's end: a ROUTER, bound. One thread uses it.
class Hub {
 public:
  /// Empty: ipc:// in a private folder (0700) under $XDG_RUNTIME_DIR or /tmp, removed by the destructor.
  /// "tcp://127.0.0.1:*" takes a free port. Error(command_line) if the endpoint cannot be bound.
  explicit Hub(const std::string& endpoint = {});
  ~Hub();
  const std::string& endpoint() const;  // where participants connect

  struct Message {
    std::string peer;  // routing id, given by ZeroMQ
    int socket = -1;   // file descriptor of the connection it came by
    wire::Parts parts;
  };
  /// The next message; nothing after `limit` or when a signal arrived.
  std::optional<Message> receive(std::chrono::milliseconds limit);
  /// Never waits and never fails: what is sent to a peer that is gone is dropped.
  void send(const std::string& peer, const wire::Parts&);
  /// Whether the connection with that descriptor stands. Heartbeats end it 0.8 s after the peer fell silent.
  bool connected(int socket);

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
};

enum class LinkEvent {
  connected,
  ready,
  disconnected,
  other
};  // connected: by the kernel; ready: greeted by ZeroMQ

/// A participant's end: a DEALER, connected. One thread uses it, a second one its monitor.
class Line {
 public:
  explicit Line(const std::string& endpoint);  // Error(command_line) if it is no endpoint
  ~Line();
  void send(const wire::Parts&);  // never waits
  std::optional<wire::Parts> receive(std::chrono::milliseconds limit);
  /// What happened to the connection; nothing after `limit`. For the watch thread.
  std::optional<LinkEvent> next_event(std::chrono::milliseconds limit);

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
};

}  // namespace strake
