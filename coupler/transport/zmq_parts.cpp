#include "coupler/transport/zmq_parts.hpp"

#include "coupler/transport/system_calls.hpp"
#include "proto/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/sockios.h>
#include <memory>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace strake::zmq_parts {
namespace {

// The I/O threads answer heartbeats, so silence means dead or frozen, never busy.
constexpr int heartbeat_every = 150;         // [ms]
constexpr int heartbeat_limit = 500;         // [ms]
constexpr std::size_t worth_sharing = 4096;  // [bytes] a smaller part is copied faster than shared

/// The owner of bytes while ZeroMQ has them. ZeroMQ hands them from thread to thread by locks of its own,
/// which the thread sanitizer does not see; `handed_over` is written before and read after them.
struct Kept {
  std::shared_ptr<const void> owner;
  std::atomic<bool> handed_over{false};
};

/// ZeroMQ gives the bytes back in its own thread once they have left.
void give_back(void*, void* kept) {
  const std::unique_ptr<Kept> own(static_cast<Kept*>(kept));
  static_cast<void>(own->handed_over.load(std::memory_order_acquire));
}

zmq::message_t to_message(const wire::Part& part) {
  if (!part.owner || part.bytes.size() < worth_sharing) return {part.bytes.data(), part.bytes.size()};
  auto kept = std::make_unique<Kept>(part.owner);
  kept->handed_over.store(true, std::memory_order_release);
  return {const_cast<std::byte*>(part.bytes.data()), part.bytes.size(), give_back, kept.release()};
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

namespace strake {

PeerCloseDetector::PeerCloseDetector(int socket) : socket_(fcntl(socket, F_DUPFD_CLOEXEC, 0)) {}

// The end of a stream is read again and again. Nothing to read yet: the other end is still open.
bool PeerCloseDetector::closed_by_peer() const {
  char byte = 0;
  const ssize_t n = recv(socket_.get(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return n == 0 || (n < 0 && (errno == ECONNRESET || errno == EPIPE));
}

int PeerCloseDetector::unread() const {
  int bytes = 0;
  return ioctl(socket_.get(), SIOCINQ, &bytes) == 0 ? bytes : 0;
}

ZapAuthenticator::ZapAuthenticator(zmq::context_t& context,
                                   const std::map<std::string, std::string>& admitted)
    : context_(context), socket_(context, zmq::socket_type::rep) {
  for (const auto& [name, key] : admitted) {
    std::array<std::uint8_t, 32> bytes{};
    if (zmq_z85_decode(bytes.data(), key.c_str())) name_of_[bytes] = name;
  }
  socket_.bind("inproc://zeromq.zap.01");
  thread_ = thread_without_signals([this] { run(); });
}

ZapAuthenticator::~ZapAuthenticator() {
  context_.shutdown();
  thread_.join();
}

std::vector<std::string> ZapAuthenticator::take_refused() {
  const std::lock_guard lock(mutex_);
  return std::exchange(refused_, {});
}

void ZapAuthenticator::run() {
  try {
    for (;;) answer(hear());
  } catch (const zmq::error_t&) {
    socket_.close();  // the context has been shut down
  }
}

/// version, request, domain, address, routing id, mechanism, key
std::vector<std::string> ZapAuthenticator::hear() {
  std::vector<std::string> parts;
  for (bool more = true; more;) try {
      zmq::message_t part;
      if (!socket_.recv(part)) continue;
      more = part.more();
      parts.push_back(part.to_string());
    } catch (const zmq::error_t& e) {
      if (e.num() != EINTR) throw;
    }
  parts.resize(std::max<std::size_t>(parts.size(), 7));
  return parts;
}

void ZapAuthenticator::answer(const std::vector<std::string>& request) {
  std::array<std::uint8_t, 32> key{};
  std::copy_n(request[6].begin(), std::min(key.size(), request[6].size()), key.begin());
  const auto found = name_of_.find(key);
  const bool known = request[5] == "CURVE" && found != name_of_.end();
  if (!known) {
    constexpr std::size_t enough = 1000;  // between two tests
    const std::lock_guard lock(mutex_);
    if (refused_.size() < enough) refused_.push_back(request[3]);
  }
  const std::array<std::string, 6> parts{"1.0",
                                         request[1],
                                         known ? "200" : "400",
                                         known ? "OK" : "no key of this run",
                                         known ? found->second : "",  // becomes the User-Id of its messages
                                         ""};
  for (std::size_t i = 0; i < parts.size(); ++i)
    socket_.send(zmq::buffer(parts[i]),
                 i + 1 < parts.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
}

}  // namespace strake
