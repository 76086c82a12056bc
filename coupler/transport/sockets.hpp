#pragma once

#include "coupler/transport/curve_keys.hpp"
#include "proto/wire/wire.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

/// The transport. ZeroMQ stays inside link.cpp.
namespace strake {

/// A new pair of CURVE keys.
KeyPair new_key_pair();
bool belong_together(const KeyPair&);

/// Who may join.
struct Admission {
  std::optional<CouplerKeys> keys;  // CURVE: all is encrypted, and only holders of a listed key come in
  bool unencrypted = false;         // without encryption keys, an endpoint that other machines can reach is
                                    // intended
};

/// The coupler's end: a ROUTER, bound. One thread uses it.
class CouplerSocket {
 public:
  /// Empty: ipc:// in a private folder (0700) under $XDG_RUNTIME_DIR or /tmp, removed by the destructor.
  /// "tcp://127.0.0.1:*" takes a free port. Error(command_line) if the endpoint cannot be bound, if something
  /// else stands at its path, or if other machines can reach it and nothing protects it.
  explicit CouplerSocket(const std::string& endpoint = {}, Admission = {});
  static constexpr int most_megabytes = 256;  // of one part of a message
  ~CouplerSocket();
  std::string endpoint() const;            // where participants of this machine connect
  std::string private_folder() const;      // where its socket stands; empty: at an endpoint of the user's
  std::string endpoint_elsewhere() const;  // the same for other machines: the host's name for a wildcard

  struct Message {
    std::string peer;  // routing id, given by ZeroMQ: another one for each connection
    std::string key;   // whose key it came with; empty without keys
    wire::Parts parts;
  };
  /// The next message; nothing after `limit` or when a signal arrived.
  std::optional<Message> receive(std::chrono::milliseconds limit);
  /// Never waits: what is sent to a peer that is gone is dropped. Error(case_file) for a part that is larger
  /// than the other end would take.
  void send(const std::string& peer, const wire::Parts&);
  /// Whether the connection of that peer stands. Heartbeats end it 0.8 s after the peer fell silent.
  bool connected(const std::string& peer);
  /// That peer takes part. Who does not is cut once it has sent more than an introduction needs.
  void admit(const std::string& peer);
  /// From this call on `left` reports how that peer's connection ends.
  void watch_close(const std::string& peer);
  /// Whether its connection has ended because it was closed at the other end, as the end of a process does.
  bool left(const std::string& peer);
  /// Whether ZeroMQ has closed its connection in the middle of what it sent. It does so with a part that is
  /// too large, and says nothing; a coupler that was frozen finds the same after its heartbeats have run out.
  bool cut_short(const std::string& peer);
  /// Whether a connection stands on which nothing has been said yet.
  bool somebody_is_new();
  /// Connections that never became one of ours since the last call: "127.0.0.1 holds no key of this run" →
  /// how often.
  std::map<std::string, int> take_strangers();

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
};

enum class LinkEvent {
  connected,       // by the kernel
  ready,           // greeted by ZeroMQ
  key_refused,     // the coupler does not admit our key
  no_greeting,     // it was cut before it was ready; ZeroMQ tries again
  other_greeting,  // it does not speak ZeroMQ, or only one side has encryption keys; ZeroMQ does not try
                   // again
  disconnected,
  other
};

/// A participant's end: a DEALER, connected. One thread uses it, a second one its monitor.
class ParticipantSocket {
 public:
  /// Error(command_line) if it is no endpoint.
  explicit ParticipantSocket(const std::string& endpoint, const std::optional<ParticipantKeys>& = {});
  ~ParticipantSocket();
  /// Never waits. Error(case_file) for a part that is larger than the other end would take.
  void send(const wire::Parts&);
  std::optional<wire::Parts> receive(std::chrono::milliseconds limit);
  /// What happened to the connection; nothing after `limit`. For the watch thread.
  std::optional<LinkEvent> next_event(std::chrono::milliseconds limit);

 private:
  struct Sockets;
  std::unique_ptr<Sockets> sockets_;
};

}  // namespace strake
