#include "coupler/link.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>
#include <zmq.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <utility>

namespace strake {
namespace {

using std::chrono::milliseconds;

// The I/O threads answer heartbeats, so silence means dead or frozen, never busy.
constexpr int heartbeat_every = 200;  // [ms]
constexpr int heartbeat_limit = 800;  // [ms]
constexpr int last_words = 500;       // [ms] a participant's Fault or Done may take to leave
constexpr std::int64_t largest_part = std::int64_t{1} << 33;  // [bytes] 3 components on 3.6e8 points
constexpr std::size_t unix_path = 107;                        // bytes of a Unix socket's address
constexpr std::size_t worth_sharing = 4096;  // [bytes] a smaller part is copied faster than shared

void set_common(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::heartbeat_ivl, heartbeat_every);
  socket.set(zmq::sockopt::heartbeat_timeout, heartbeat_limit);
  socket.set(zmq::sockopt::heartbeat_ttl, heartbeat_limit);
  socket.set(zmq::sockopt::maxmsgsize, largest_part);
}

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
    socket_.connect(address);
  }
  ~Monitor() { zmq_socket_monitor(watched_.handle(), nullptr, 0); }
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;

  std::optional<Event> next(milliseconds limit);

 private:
  zmq::socket_t& watched_;
  zmq::socket_t socket_;
};

/// Whether the socket has something to read; false after `limit` or when a signal arrived.
bool readable(zmq::socket_t& socket, milliseconds limit) {
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

std::optional<Monitor::Event> Monitor::next(milliseconds limit) {
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

zmq::message_t to_message(const wire::Part& part) {
  if (!part.owner || part.bytes.size() < worth_sharing) return {part.bytes.data(), part.bytes.size()};
  // ZeroMQ gives the bytes back in its own thread once they have left.
  auto* keep = new std::shared_ptr<const void>(part.owner);
  const auto release = [](void*, void* hint) { delete static_cast<std::shared_ptr<const void>*>(hint); };
  return {const_cast<std::byte*>(part.bytes.data()), part.bytes.size(), release, keep};
}

void send_parts(zmq::socket_t& socket, const wire::Parts& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    zmq::message_t message = to_message(parts[i]);
    auto flags = zmq::send_flags::dontwait;
    if (i + 1 < parts.size()) flags = flags | zmq::send_flags::sndmore;
    for (bool sent = false; !sent;) try {
        if (!socket.send(message, flags)) return;  // no room: the peer has long been gone
        sent = true;
      } catch (const zmq::error_t& e) {
        if (e.num() == EHOSTUNREACH) return;
        if (e.num() != EINTR) throw;
      }
  }
}

/// The rest of a message, each part kept where ZeroMQ put it.
wire::Parts receive_rest(zmq::socket_t& socket, bool more) {
  wire::Parts parts;
  while (more) {
    auto message = std::make_shared<zmq::message_t>();
    if (!receive_part(socket, *message)) break;  // parts of one message arrive together
    more = message->more();
    parts.push_back({{static_cast<const std::byte*>(message->data()), message->size()}, message});
  }
  return parts;
}

/// A folder that only this user may enter, removed at the end.
class PrivateFolder {
 public:
  PrivateFolder() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    for (const std::string& base : {std::string(runtime ? runtime : ""), std::string("/tmp")}) {
      std::string pattern = base + "/strake-XXXXXX";
      if (base.empty() || pattern.size() + 4 > unix_path) continue;
      if (mkdtemp(pattern.data())) {
        path_ = pattern;
        return;
      }
    }
    throw Error(ExitCode::cannot_write, "/tmp",
                fmt::format("no folder for the socket: {}", std::strerror(errno)),
                "set XDG_RUNTIME_DIR to a folder of yours");
  }
  ~PrivateFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What crosses a network must be encrypted; ipc and loopback do not leave the machine.
bool stays_here(const std::string& endpoint) {
  for (const char* start : {"ipc://", "tcp://127.", "tcp://localhost:", "tcp://[::1]:"})
    if (endpoint.starts_with(start)) return true;
  return false;
}

}  // namespace

struct Hub::Sockets {
  std::unique_ptr<PrivateFolder> folder;  // first: it goes last
  zmq::context_t context{1};
  zmq::socket_t router{context, zmq::socket_type::router};
  Monitor monitor{context, router, "hub", ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED};
  std::string endpoint;
  std::set<int> open;  // descriptors of the connections that stand
};

Hub::Hub(const std::string& endpoint) : sockets_(std::make_unique<Sockets>()) {
  Sockets& s = *sockets_;
  std::string wanted = endpoint;
  if (wanted.empty()) {
    s.folder = std::make_unique<PrivateFolder>();
    wanted = "ipc://" + (s.folder->path() / "hub").string();
  }
  if (!stays_here(wanted))
    throw Error(ExitCode::command_line, wanted,
                "is no endpoint of this machine, and encryption is not built yet",
                "ipc://PATH or tcp://127.0.0.1:*");
  set_common(s.router);
  s.router.set(zmq::sockopt::linger, 0);
  try {
    s.router.bind(wanted);
  } catch (const zmq::error_t& e) {
    throw Error(ExitCode::command_line, wanted, fmt::format("cannot be bound: {}", e.what()));
  }
  s.endpoint = s.router.get(zmq::sockopt::last_endpoint);
}

Hub::~Hub() = default;

const std::string& Hub::endpoint() const {
  return sockets_->endpoint;
}

std::optional<Hub::Message> Hub::receive(milliseconds limit) {
  zmq::socket_t& router = sockets_->router;
  if (!readable(router, limit)) return {};
  zmq::message_t peer;
  if (!receive_part(router, peer)) return {};
  Message message{peer.to_string(), -1, receive_rest(router, peer.more())};
  if (!message.parts.empty()) {
    const auto* first = static_cast<const zmq::message_t*>(message.parts.front().owner.get());
    message.socket = zmq_msg_get(const_cast<zmq_msg_t*>(first->handle()), ZMQ_SRCFD);
  }
  return message;
}

void Hub::send(const std::string& peer, const wire::Parts& parts) {
  wire::Parts addressed{{std::as_bytes(std::span(peer)), nullptr}};
  addressed.insert(addressed.end(), parts.begin(), parts.end());
  send_parts(sockets_->router, addressed);
}

bool Hub::connected(int socket) {
  while (const auto event = sockets_->monitor.next(milliseconds(0))) {
    if (event->kind == ZMQ_EVENT_ACCEPTED) sockets_->open.insert(event->value);
    if (event->kind == ZMQ_EVENT_DISCONNECTED) sockets_->open.erase(event->value);
  }
  return sockets_->open.contains(socket);
}

struct Line::Sockets {
  zmq::context_t context{1};
  zmq::socket_t dealer{context, zmq::socket_type::dealer};
  Monitor monitor{
      context, dealer, "line",
      ZMQ_EVENT_CONNECTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED | ZMQ_EVENT_CLOSED};
};

Line::Line(const std::string& endpoint) : sockets_(std::make_unique<Sockets>()) {
  set_common(sockets_->dealer);
  sockets_->dealer.set(zmq::sockopt::linger, last_words);
  if (!stays_here(endpoint))
    throw Error(ExitCode::command_line, "--connect " + endpoint,
                "is no endpoint of this machine, and encryption is not built yet",
                "ipc://PATH or tcp://127.0.0.1:PORT");
  try {
    sockets_->dealer.connect(endpoint);
  } catch (const zmq::error_t& e) {
    throw Error(ExitCode::command_line, "--connect " + endpoint,
                fmt::format("cannot be connected: {}", e.what()));
  }
}

Line::~Line() = default;

void Line::send(const wire::Parts& parts) {
  send_parts(sockets_->dealer, parts);
}

std::optional<wire::Parts> Line::receive(milliseconds limit) {
  if (!readable(sockets_->dealer, limit)) return {};
  wire::Parts parts = receive_rest(sockets_->dealer, true);
  if (parts.empty()) return {};
  return parts;
}

std::optional<LinkEvent> Line::next_event(milliseconds limit) {
  const auto event = sockets_->monitor.next(limit);
  if (!event) return {};
  switch (event->kind) {
    case ZMQ_EVENT_CONNECTED:
      return LinkEvent::connected;
    case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
      return LinkEvent::ready;
    case ZMQ_EVENT_DISCONNECTED:
      return LinkEvent::disconnected;
    default:
      return LinkEvent::other;
  }
}

}  // namespace strake
