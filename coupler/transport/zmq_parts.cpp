#include "coupler/transport/zmq_parts.hpp"

#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace strake::zmq_parts {
namespace {

// The I/O threads answer heartbeats, so silence means dead or frozen, never busy.
constexpr int heartbeat_every = 150;         // [ms]
constexpr int heartbeat_limit = 500;         // [ms]
constexpr std::size_t worth_sharing = 4096;  // [bytes] a smaller part is copied faster than shared

/// ZeroMQ gives the bytes back in its own thread once they have left.
void give_back(void*, void* owner) {
  delete static_cast<std::shared_ptr<const void>*>(owner);
}

zmq::message_t to_message(const wire::Part& part) {
  if (!part.owner || part.bytes.size() < worth_sharing) return {part.bytes.data(), part.bytes.size()};
  auto* keep = new std::shared_ptr<const void>(part.owner);
  return {const_cast<std::byte*>(part.bytes.data()), part.bytes.size(), give_back, keep};
}

/// Whether the socket has something to read; false after `limit` or when a signal arrived.
bool readable(zmq::socket_t& socket, std::chrono::milliseconds limit) {
  zmq::pollitem_t item{socket.handle(), 0, ZMQ_POLLIN, 0};
  try {
    return zmq::poll(&item, 1, limit) > 0;
  } catch (const zmq::error_t& e) {
    if (e.num() == EINTR) return false;
    throw;
  }
}

/// One part; nothing when a signal arrived before it came.
bool receive_part(zmq::socket_t& socket, zmq::message_t& into) {
  for (int attempt = 0;; ++attempt) try {
      return socket.recv(into, zmq::recv_flags::dontwait).has_value();
    } catch (const zmq::error_t& e) {
      if (e.num() != EINTR || attempt > 100) throw;
    }
}

}  // namespace

void refuse_too_large(const wire::Parts& parts, const std::string& what) {
  constexpr double megabyte = 1 << 20;
  for (const wire::Part& part : parts)
    if (static_cast<std::int64_t>(part.bytes.size()) > largest_part)
      throw Error(ExitCode::case_file, "",
                  fmt::format("{} has {:.0f} MB, a message carries at most {:.0f} MB", what,
                              static_cast<double>(part.bytes.size()) / megabyte,
                              static_cast<double>(largest_part) / megabyte),
                  "a coarser interface mesh");
}

void set_common(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::heartbeat_ivl, heartbeat_every);
  socket.set(zmq::sockopt::heartbeat_timeout, heartbeat_limit);
  socket.set(zmq::sockopt::heartbeat_ttl, heartbeat_limit);
  socket.set(zmq::sockopt::maxmsgsize, largest_part);
}

std::optional<Monitor::Event> Monitor::next(std::chrono::milliseconds limit) {
  if (!readable(socket_, limit)) return {};
  zmq::message_t header, address;
  if (!receive_part(socket_, header) || header.size() != 6) return {};
  receive_part(socket_, address);
  std::uint16_t kind = 0;  // packed: 16 bits of event, 32 bits of value
  std::uint32_t value = 0;
  std::memcpy(&kind, header.data(), sizeof kind);
  std::memcpy(&value, static_cast<const char*>(header.data()) + sizeof kind, sizeof value);
  return Event{kind, static_cast<int>(value)};
}

bool await_part(zmq::socket_t& socket, zmq::message_t& into, std::chrono::milliseconds limit) {
  socket.set(zmq::sockopt::rcvtimeo, static_cast<int>(std::max<std::int64_t>(limit.count(), 0)));
  try {
    return socket.recv(into).has_value();
  } catch (const zmq::error_t& e) {
    if (e.num() == EINTR) return false;
    throw;
  }
}

wire::Part to_part(const std::shared_ptr<zmq::message_t>& message) {
  return {{static_cast<const std::byte*>(message->data()), message->size()}, message};
}

void receive_rest(zmq::socket_t& socket, bool more, wire::Parts& parts) {
  while (more) {
    const auto message = std::make_shared<zmq::message_t>();
    if (!receive_part(socket, *message)) break;  // parts of one message arrive together
    more = message->more();
    parts.push_back(to_part(message));
  }
}

bool send_part(zmq::socket_t& socket, zmq::message_t message, bool more) {
  const auto flags = zmq::send_flags::dontwait | (more ? zmq::send_flags::sndmore : zmq::send_flags::none);
  for (;;) try {
      return socket.send(message, flags).has_value();
    } catch (const zmq::error_t& e) {
      if (e.num() == EHOSTUNREACH) return false;
      if (e.num() != EINTR) throw;
    }
}

void send_parts(zmq::socket_t& socket, const wire::Parts& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!send_part(socket, to_message(parts[i]), i + 1 < parts.size())) return;
}

}  // namespace strake::zmq_parts
