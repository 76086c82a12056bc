#pragma once

#include <memory>
#include <string>

namespace strake::watch {

class Answers;

/// Serves a page to who knows its token, and to nobody else: the token is the first part of every path, so
/// that an address is all that a reader needs. Only GET and HEAD; a request whose Host is a name that this
/// server was not bound to is refused, so that no foreign page can reach it by a name that it points here
/// (DNS rebinding).
class Server {
 public:
  struct Options {
    std::string bind = "127.0.0.1";  // address or name of an interface of this machine
    int port = 0;                    // 0: any that is free
    std::string token;               // hexadecimal
  };
  /// Binds; throws Error(command_line) where it cannot. Answers must outlive it.
  Server(Answers&, Options);
  ~Server();  // stops
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void start();  // in threads of its own
  void stop();
  int port() const;
  /// "http://127.0.0.1:8137/3f…/"
  std::string address() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether a Host header ("localhost:8137") names what was bound: the bound name itself, a name or address of
/// loopback, or, bound to every interface, any numeric address and this machine's own name; with that port.
bool host_is_ours(const std::string& host, const std::string& bind, int port);
/// Whether an address leaves this machine.
bool is_loopback(const std::string& address);

}  // namespace strake::watch
