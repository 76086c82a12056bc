#pragma once

#include "coupler/transport/sockets.hpp"
#include "proto/descriptor.hpp"
#include "proto/wire/wire.hpp"

#include <zmq.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

/// What both ends of a connection do with ZeroMQ's sockets, for sockets.cpp alone.
namespace strake::zmq_parts {

// Limit for a part of a message. ZeroMQ allocates a part as soon as its size is announced, by anyone who has
// greeted as ZeroMQ does. It fixes the limit when it binds, before any mesh is known. Room for 3 components
// on 1.1e7 points.
inline constexpr std::int64_t largest_part = std::int64_t{CouplerSocket::most_megabytes} << 20;  // [bytes]

/// Error(case_file) for a part that no message carries; it starts with `what` it is: "one field of …".
void refuse_too_large(const wire::Parts&, const std::string& what);

/// Heartbeats, and the largest part that is taken.
void set_common(zmq::socket_t&);

/// What ZeroMQ reports about one socket, read through a socket of its own, so that another thread may do so.
class Monitor {
 public:
  struct Event {
    int kind = 0, value = 0;
  };
  Monitor(zmq::context_t& context, zmq::socket_t& watched, const std::string& name, int kinds)
      : watched_(watched), socket_(context, zmq::socket_type::pair) {
    const std::string address = "inproc://" + name;
    if (zmq_socket_monitor(watched.handle(), address.c_str(), kinds) != 0) throw zmq::error_t();
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::rcvhwm, 0);  // a full queue would stop the I/O thread, heartbeats and all
    socket_.connect(address);
  }
  ~Monitor() { zmq_socket_monitor(watched_.handle(), nullptr, 0); }
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;

  std::optional<Event> next(std::chrono::milliseconds limit);

 private:
  zmq::socket_t& watched_;
  zmq::socket_t socket_;
};

/// The first part of a message; nothing after `limit` or when a signal arrived. A receive that waits itself
/// needs one system call; with a poll before it there are three.
bool await_part(zmq::socket_t&, zmq::message_t& into, std::chrono::milliseconds limit);
/// Adds the rest of a message, each part where ZeroMQ put it.
void receive_rest(zmq::socket_t&, bool more, wire::Parts& parts);
wire::Part to_part(const std::shared_ptr<zmq::message_t>&);

/// Never waits. False when it cannot go: the peer has long been gone.
bool send_part(zmq::socket_t&, zmq::message_t, bool more);
void send_parts(zmq::socket_t&, const wire::Parts&);

}  // namespace strake::zmq_parts

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

/// Admits to ZeroMQ whoever has one of the admitted encryption keys (the request is described in RFC 27/ZAP).
/// It runs in a thread of its own, since the coupler may be computing.
class ZapAuthenticator {
 public:
  /// admitted: participant → public key in Z85.
  ZapAuthenticator(zmq::context_t&, const std::map<std::string, std::string>& admitted);
  ~ZapAuthenticator();  // shuts the context down, which is what its thread waits for
  ZapAuthenticator(const ZapAuthenticator&) = delete;
  ZapAuthenticator& operator=(const ZapAuthenticator&) = delete;

  /// Addresses that came with another key, since the last call.
  std::vector<std::string> take_refused();

 private:
  void run();
  std::vector<std::string> hear();
  void answer(const std::vector<std::string>& request);

  zmq::context_t& context_;
  zmq::socket_t socket_;
  std::map<std::array<std::uint8_t, 32>, std::string> name_of_;
  std::mutex mutex_;
  std::vector<std::string> refused_;
  std::thread thread_;
};

}  // namespace strake
