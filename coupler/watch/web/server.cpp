#include "coupler/watch/web/server.hpp"

#include "coupler/transport/system_calls.hpp"
#include "coupler/watch/web/http_api.hpp"
#include "coupler/watch/web/waiting_connections.hpp"  // last: it brings resolv.h, whose macro _res is a name of Eigen's
#include "proto/error.hpp"
#include "proto/text.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <thread>

namespace strake::watch {
namespace {

bool is_numeric(const std::string& address) {
  std::array<unsigned char, 16> bytes{};
  return ::inet_pton(AF_INET, address.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, address.c_str(), bytes.data()) == 1;
}

bool is_any(const std::string& address) {
  return address == "0.0.0.0" || address == "::";
}

/// The comparison takes equal time, wherever the first difference is.
bool equal(const std::string& a, const std::string& b) {
  return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

void refuse(httplib::Response& response, int status, const std::string& sentence) {
  response.status = status;
  response.set_content(sentence + "\n", "text/plain; charset=utf-8");
}

/// "/3f…/api/news" → ("3f…", "api/news").
std::pair<std::string, std::string> split(const std::string& path) {
  const auto end = path.find('/', 1);
  if (path.empty() || path[0] != '/') return {};
  if (end == std::string::npos) return {path.substr(1), "/"};
  return {path.substr(1, end - 1), path.substr(end + 1)};
}

}  // namespace

bool is_loopback(const std::string& address) {
  const std::string name = lower_case(address);
  std::array<unsigned char, 16> bytes{};
  if (name == "localhost" || name == "::1") return true;
  return ::inet_pton(AF_INET, name.c_str(), bytes.data()) == 1 && bytes[0] == 127;
}

bool host_is_ours(const std::string& host, const std::string& bind, int port) {
  std::string name = lower_case(host), given_port;
  if (name.starts_with('[')) {
    const auto close = name.find(']');
    if (close == std::string::npos) return false;
    given_port = name.substr(close + 1);
    name = name.substr(1, close - 1);
  } else if (const auto colon = name.rfind(':'); colon != std::string::npos) {
    given_port = name.substr(colon);
    name = name.substr(0, colon);
  }
  if (given_port != fmt::format(":{}", port) && !(given_port.empty() && port == 80)) return false;
  if (name == lower_case(bind) || is_loopback(name)) return true;
  return is_any(bind) && (is_numeric(name) || name == lower_case(host_name()));
}

struct Server::State {
  State(HttpApi& a, Options o) : api(a), options(std::move(o)) {}

  void handle(const httplib::Request& request, httplib::Response& response) const {
    response.set_header("Cache-Control", "no-store");
    response.set_header(
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response.set_header("Cross-Origin-Resource-Policy", "same-origin");
    response.set_header("Cross-Origin-Opener-Policy", "same-origin");
    response.set_header("Referrer-Policy", "no-referrer");
    response.set_header("X-Content-Type-Options", "nosniff");
    if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      return refuse(response, 405, "this server takes GET and HEAD only");
    }
    if (!host_is_ours(request.get_header_value("Host"), options.bind, port))
      return refuse(response, 403,
                    "this page is not served under that name; use the address that strake watch printed");
    const auto [token, path] = split(request.path);
    if (!equal(token, options.token))
      return refuse(response, 403,
                    "this address holds no valid token; use the whole address that strake watch printed, up "
                    "to its last /");
    if (path == "/") {  // without it the page's own files would be searched beside it
      response.set_redirect("/" + options.token + "/");
      return;
    }
    HttpApi::Query query;
    for (const auto& [key, value] : request.params) query[key] = value;
    HttpApi::Answer answer = api.answer(path, query);
    response.status = answer.status;
    response.set_content(answer.body, answer.type);
  }

  HttpApi& api;
  Options options;
  PatientServer server;
  int port = 0;
  std::thread thread;
};

Server::Server(HttpApi& api, Options options) : state_(std::make_unique<State>(api, std::move(options))) {
  PatientServer& server = state_->server;
  server.set_keep_alive_max_count(1'000'000);
  server.set_payload_max_length(0);  // questions have no body
  server.set_tcp_nodelay(true);
  // Its default also sets SO_REUSEPORT, with which two servers share one port unasked.
  server.set_socket_options([](int socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_pre_routing_handler(
      [state = state_.get()](const httplib::Request& request, httplib::Response& response) {
        state->handle(request, response);
        return httplib::Server::HandlerResponse::Handled;
      });
  const Options& o = state_->options;
  if (o.port == 0)
    state_->port = server.bind_to_any_port(o.bind);
  else
    state_->port = server.bind_to_port(o.bind, o.port) ? o.port : -1;
  if (state_->port <= 0)
    throw Error(
        ExitCode::command_line, o.port == 0 ? "--bind " + o.bind : fmt::format("--port {}", o.port),
        o.port == 0
            ? "is no address of this machine"
            : fmt::format("cannot be had on {}: another program listens there, or it is not allowed", o.bind),
        o.port == 0 ? "--bind 127.0.0.1" : "leave out --port, and a free one is taken");
  server.widen_queue();
}

Server::~Server() {
  stop();
}

void Server::start() {
  state_->thread = thread_without_signals([state = state_.get()] { state->server.listen_after_bind(); });
  while (!state_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void Server::stop() {
  state_->server.stop();
  if (state_->thread.joinable()) state_->thread.join();
}

int Server::port() const {
  return state_->port;
}

std::string Server::address() const {
  const std::string& bind = state_->options.bind;
  std::string host = is_any(bind) ? host_name() : bind;
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/{}/", host, state_->port, state_->options.token);
}

}  // namespace strake::watch
