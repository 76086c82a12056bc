#pragma once

#include <memory>
#include <string>

namespace strake::watch {

class HttpApi;

/// Serves a page to readers who know its token. The token is the first part of every path, so that an address
/// is all that a reader needs. Only GET and HEAD. A request whose Host is a name that this server was not
/// bound to is refused. So no foreign page can reach it by a name that it points here (DNS rebinding).
class Server {
 public:
  struct Options {
    std::string bind = "127.0.0.1";  // address or name of an interface of this machine
    int port = 0;                    // 0: any that is free
    std::string token;               // hexadecimal
  };
  /// Binds; throws Error(command_line) where it cannot. HttpApi must outlive it.
  Server(HttpApi&, Options);
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

/// True if a Host header ("localhost:8137") has the port and names what was bound. This is the bound name
/// itself, or a name or address of loopback. If the server is bound to every interface, it is also any
/// numeric address and this machine's own name.
bool host_is_ours(const std::string& host, const std::string& bind, int port);
/// Whether an address leaves this machine.
bool is_loopback(const std::string& address);

}  // namespace strake::watch
