#include "coupler/transport/sockets.hpp"

#include "coupler/transport/connection_limit.hpp"
#include "coupler/transport/endpoint.hpp"
#include "coupler/transport/system_calls.hpp"
#include "coupler/transport/unix_listener.hpp"
#include "coupler/transport/zmq_parts.hpp"

#include <fmt/format.h>
#include <zmq.hpp>

#include <array>
#include <set>
#include <sys/resource.h>
#include <utility>

namespace strake {
namespace {

using namespace zmq_parts;
using std::chrono::milliseconds;

constexpr int farewell_linger = 500;  // [ms] a participant's Fault or Done may take to leave
constexpr int to_greet = 3000;        // [ms] a connection that has not greeted by then is cut

/// Where others may come, the run needs descriptors for its own files and for those who wait outside.
void raise_file_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

KeyPair new_key_pair() {
  std::array<char, 41> of_all{}, of_one{};
  if (zmq_curve_keypair(of_all.data(), of_one.data()) != 0)
    throw Error(ExitCode::our_bug, "libzmq", "was built without CURVE");
  return {of_all.data(), of_one.data()};
}

bool belong_together(const KeyPair& pair) {
  std::array<char, 41> key{};
  return zmq_curve_public(key.data(), pair.secret_key.c_str()) == 0 && pair.public_key == key.data();
}

struct CouplerSocket::Sockets {
  std::unique_ptr<PrivateFolder> folder;  // first: it goes last
  std::unique_ptr<UnixListener> listener;
  zmq::context_t context{1};
  zmq::socket_t router{context, zmq::socket_type::router};
  Monitor monitor{context, router, "hub",
                  ZMQ_EVENT_LISTENING | ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED |
                      ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL};
  ConnectionLimit limit;
  std::unique_ptr<ZapAuthenticator> authenticator;  // last: it goes first, and takes the context along
  std::string endpoint;
  struct Connection {
    std::string address;
    std::string peer;  // routing id; empty while it has said nothing
    std::unique_ptr<PeerCloseDetector> close_detector;
  };
  std::map<int, Connection> open;   // by descriptor
  std::set<std::string> left;       // peers that had a detector and closed their connection
  std::set<std::string> cut_short;  // peers that had a detector, and whose connection ended while they sent
  std::string failed;               // why the connection that is about to be closed never stood
  std::map<std::string, int> strangers;

  void bind(const std::string& wanted);
  void update();
  void stranger(const std::string& text, int times = 1);
  void heard(const std::string& peer, int socket);
  Connection* find(const std::string& peer, int* socket = nullptr);
  std::string reason(const Monitor::Event&) const;
};

void CouplerSocket::Sockets::stranger(const std::string& text, int times) {
  constexpr std::size_t enough = 100;
  strangers[strangers.size() < enough ? text : "others were refused too"] += times;
}

/// Events of the connections since the last call.
void CouplerSocket::Sockets::update() {
  while (const auto event = monitor.next(milliseconds(0))) switch (event->kind) {
      case ZMQ_EVENT_ACCEPTED:
        open[event->value] = {peer_address(event->value), {}, nullptr};
        break;
      case ZMQ_EVENT_DISCONNECTED: {
        constexpr int much = 1 << 16;  // [bytes] heartbeats have less
        const Connection& c = open[event->value];
        if (c.peer.empty() && failed.empty()) failed = " left or was cut before its first word";
        if (!failed.empty()) stranger(c.address + failed);
        if (c.close_detector && c.close_detector->closed_by_peer()) left.insert(c.peer);
        if (c.close_detector && c.close_detector->unread() > much) cut_short.insert(c.peer);
        failed.clear();
        open.erase(event->value);
        break;
      }
      case ZMQ_EVENT_LISTENING:
        break;
      default:  // followed by the end of the same connection
        failed = reason(*event);
    }
  for (const auto& [what, times] : limit.take_refused()) stranger(what, times);
  if (authenticator)
    for (const std::string& address : authenticator->take_refused())
      stranger(address + " holds no key of this run");
}

/// A word of a peer that came by the connection with that descriptor.
void CouplerSocket::Sockets::heard(const std::string& peer, int socket) {
  const auto known = open.find(socket);
  if (known != open.end() && known->second.peer == peer) return;
  update();  // the descriptor may have been that of another connection
  const auto found = open.find(socket);
  if (found != open.end()) found->second.peer = peer;  // else it has left in the meantime
}

CouplerSocket::Sockets::Connection* CouplerSocket::Sockets::find(const std::string& peer, int* socket) {
  for (auto& [descriptor, connection] : open)
    if (connection.peer == peer) {
      if (socket) *socket = descriptor;
      return &connection;
    }
  return nullptr;
}

std::string CouplerSocket::Sockets::reason(const Monitor::Event& event) const {
  const bool protocol = event.kind == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL;
  if (protocol && event.value == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH)
    return authenticator ? " comes without a key" : " does not greet plainly, and this run has no keys";
  if (protocol && event.value == ZMQ_PROTOCOL_ERROR_ZMTP_CRYPTOGRAPHIC)
    return " has the key of another coupler";
  return " did not greet as ZeroMQ does";
}

/// A Unix socket is bound here, since ZeroMQ removes what stands at its path.
void CouplerSocket::Sockets::bind(const std::string& wanted) {
  if (const std::string path = path_of(wanted); !path.empty()) {
    listener = std::make_unique<UnixListener>(path, folder != nullptr);
    router.set(zmq::sockopt::use_fd, listener->descriptor());
  }
  try {
    router.bind(wanted);
  } catch (const zmq::error_t& e) {
    throw Error(ExitCode::command_line, wanted, fmt::format("cannot be bound: {}", e.what()),
                "ipc://PATH, tcp://127.0.0.1:PORT, or tcp://ADDRESS:PORT with an address of this machine");
  }
  if (listener) listener->hand_over();
  constexpr milliseconds at_once{1000};
  if (const auto event = monitor.next(at_once); event && event->kind == ZMQ_EVENT_LISTENING)
    limit.guard(event->value);
  endpoint = router.get(zmq::sockopt::last_endpoint);
}

CouplerSocket::CouplerSocket(const std::string& endpoint, Admission admission)
    : sockets_(std::make_unique<Sockets>()) {
  Sockets& s = *sockets_;
  std::string wanted = endpoint;
  if (wanted.empty()) {
    s.folder = std::make_unique<PrivateFolder>();
    wanted = "ipc://" + (s.folder->path() / "hub").string();
  }
  if (const std::string problem = problem_of_endpoint(wanted); !problem.empty())
    throw Error(ExitCode::command_line, wanted, problem, "ipc://PATH or tcp://ADDRESS:PORT");
  if (leaves_machine(wanted) && !admission.keys && !admission.unencrypted)
    throw Error(ExitCode::command_line, wanted, "can be reached from other machines, and nothing protects it",
                "ipc://PATH or tcp://127.0.0.1:*, or keys (strake keys)");
  if (!s.folder) raise_file_limit();
  set_common(s.router);
  s.router.set(zmq::sockopt::linger, 0);
  s.router.set(zmq::sockopt::handshake_ivl, to_greet);
  s.router.set(zmq::sockopt::backlog, accept_queue);
  if (admission.keys) {
    s.authenticator = std::make_unique<ZapAuthenticator>(s.context, admission.keys->admitted);
    s.router.set(zmq::sockopt::zap_domain, "strake");
    s.router.set(zmq::sockopt::curve_server, true);
    s.router.set(zmq::sockopt::curve_secretkey, admission.keys->own.secret_key);
  }
  s.bind(wanted);
}

CouplerSocket::~CouplerSocket() = default;

std::string CouplerSocket::endpoint() const {
  return with_host(sockets_->endpoint, "127.0.0.1");
}

std::string CouplerSocket::private_folder() const {
  return sockets_->folder ? sockets_->folder->path().string() : "";
}

std::string CouplerSocket::endpoint_elsewhere() const {
  return with_host(sockets_->endpoint, host_name());
}

std::optional<CouplerSocket::Message> CouplerSocket::receive(milliseconds limit) {
  zmq::socket_t& router = sockets_->router;
  zmq::message_t peer;
  if (!await_part(router, peer, limit)) return {};
  Message message{peer.to_string(), {}, {}};
  receive_rest(router, peer.more(), message.parts);
  if (!message.parts.empty()) {
    const auto* first = static_cast<const zmq::message_t*>(message.parts.front().owner.get());
    sockets_->heard(message.peer, zmq_msg_get(const_cast<zmq_msg_t*>(first->handle()), ZMQ_SRCFD));
    const char* key = sockets_->authenticator ? zmq_msg_gets(first->handle(), "User-Id") : nullptr;
    if (key) message.key = key;
  }
  return message;
}

void CouplerSocket::send(const std::string& peer, const wire::Parts& parts) {
  refuse_too_large(parts, "one field for it");
  if (send_part(sockets_->router, {peer.data(), peer.size()}, true)) send_parts(sockets_->router, parts);
}

bool CouplerSocket::connected(const std::string& peer) {
  sockets_->update();
  return sockets_->find(peer) != nullptr;
}

void CouplerSocket::admit(const std::string& peer) {
  sockets_->update();
  int socket = -1;
  if (sockets_->find(peer, &socket)) sockets_->limit.admit(socket);
}

void CouplerSocket::watch_close(const std::string& peer) {
  sockets_->update();
  int socket = -1;
  if (auto* connection = sockets_->find(peer, &socket))
    connection->close_detector = std::make_unique<PeerCloseDetector>(socket);
  else
    sockets_->left.insert(peer);  // just heard: it cannot have been silent for long
}

bool CouplerSocket::left(const std::string& peer) {
  sockets_->update();
  return sockets_->left.contains(peer);
}

bool CouplerSocket::cut_short(const std::string& peer) {
  sockets_->update();
  return sockets_->cut_short.contains(peer);
}

bool CouplerSocket::somebody_is_new() {
  sockets_->update();
  return sockets_->find({}) != nullptr;
}

std::map<std::string, int> CouplerSocket::take_strangers() {
  sockets_->update();
  return std::exchange(sockets_->strangers, {});
}

struct ParticipantSocket::Sockets {
  zmq::context_t context{1};
  zmq::socket_t dealer{context, zmq::socket_type::dealer};
  Monitor monitor{context, dealer, "line",
                  ZMQ_EVENT_CONNECTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED |
                      ZMQ_EVENT_CLOSED | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL |
                      ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH};
};

ParticipantSocket::ParticipantSocket(const std::string& endpoint, const std::optional<ParticipantKeys>& keys)
    : sockets_(std::make_unique<Sockets>()) {
  zmq::socket_t& dealer = sockets_->dealer;
  set_common(dealer);
  dealer.set(zmq::sockopt::linger, farewell_linger);
  if (keys) {
    dealer.set(zmq::sockopt::curve_serverkey, keys->coupler);
    dealer.set(zmq::sockopt::curve_publickey, keys->own.public_key);
    dealer.set(zmq::sockopt::curve_secretkey, keys->own.secret_key);
  }
  try {
    sockets_->dealer.connect(endpoint);
  } catch (const zmq::error_t& e) {
    throw Error(ExitCode::command_line, "--connect " + endpoint,
                fmt::format("cannot be connected: {}", e.what()), "the endpoint that the coupler printed");
  }
}

ParticipantSocket::~ParticipantSocket() = default;

void ParticipantSocket::send(const wire::Parts& parts) {
  refuse_too_large(parts, "one field of its interface");
  send_parts(sockets_->dealer, parts);
}

std::optional<wire::Parts> ParticipantSocket::receive(milliseconds limit) {
  const auto first = std::make_shared<zmq::message_t>();
  if (!await_part(sockets_->dealer, *first, limit)) return {};
  wire::Parts parts{to_part(first)};
  receive_rest(sockets_->dealer, first->more(), parts);
  return parts;
}

std::optional<LinkEvent> ParticipantSocket::next_event(milliseconds limit) {
  const auto event = sockets_->monitor.next(limit);
  if (!event) return {};
  switch (event->kind) {
    case ZMQ_EVENT_CONNECTED:
      return LinkEvent::connected;
    case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
      return LinkEvent::ready;
    case ZMQ_EVENT_DISCONNECTED:
      return LinkEvent::disconnected;
    case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
      return LinkEvent::key_refused;
    case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
      return LinkEvent::other_greeting;
    case ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL:
      return LinkEvent::no_greeting;
    default:
      return LinkEvent::other;
  }
}

}  // namespace strake
