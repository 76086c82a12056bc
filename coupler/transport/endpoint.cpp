#include "coupler/transport/endpoint.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace strake {
namespace {

std::string problem_of_path(const std::string& path) {
  if (path.empty() || path == "@") return "has no path after ipc://";
  if (path.front() == '*') return "has no path after ipc://; \"ipc\" alone makes one";
  if (path.size() > unix_path)
    return fmt::format("has a path of {} bytes, a socket's has at most {}", path.size(), unix_path);
  if (path.ends_with('/')) return "is a folder, expected the path of a socket";
  if (std::any_of(path.begin(), path.end(), [](unsigned char c) { return c < ' ' || c == 127; }))
    return "has a control character in its path";
  return "";
}

std::string problem_of_port(const std::string& port) {
  constexpr int largest = 65535;
  if (port == "*") return "";
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  const int number = digits ? std::stoi(port) : 0;
  if (number < 1 || number > largest)
    return fmt::format("has the port \"{}\", expected 1 to {}, or * for a free one", port, largest);
  return "";
}

std::string problem_of_host(const std::string& host) {
  if (host.empty()) return "has no address before its port";
  const bool brackets = host.front() == '[' && host.back() == ']' && host.size() > 2;
  const std::string name = brackets ? host.substr(1, host.size() - 2) : host;
  const auto plain = [brackets](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '-' || c == '_' || (brackets && (c == ':' || c == '%'));
  };
  if (host == "*" || std::all_of(name.begin(), name.end(), plain)) return "";
  return fmt::format("has the address \"{}\", expected a number like 127.0.0.1 or [::1], or a name", host);
}

}  // namespace

std::string problem_of_endpoint(const std::string& endpoint) {
  if (endpoint.starts_with("ipc://")) return problem_of_path(path_of(endpoint));
  const std::string scheme = "tcp://";
  if (!endpoint.starts_with(scheme)) return "is neither ipc://PATH nor tcp://ADDRESS:PORT";
  const std::string rest = endpoint.substr(scheme.size());
  const std::size_t colon = rest.rfind(':');
  const bool inside = colon != std::string::npos && rest.find(']', colon) != std::string::npos;
  if (colon == std::string::npos || inside) return "has no port, expected tcp://ADDRESS:PORT";
  const std::string problem = problem_of_host(rest.substr(0, colon));
  return problem.empty() ? problem_of_port(rest.substr(colon + 1)) : problem;
}

bool leaves_machine(const std::string& endpoint) {
  if (endpoint.starts_with("ipc://")) return false;
  const std::size_t begin = endpoint.find("://"), end = endpoint.rfind(':');
  if (begin == std::string::npos || end <= begin) return true;
  const std::string host = endpoint.substr(begin + 3, end - begin - 3);
  const bool numbers = host.find_first_not_of("0123456789.") == std::string::npos;
  return !(host == "localhost" || host == "[::1]" || (numbers && host.starts_with("127.")));
}

std::string path_of(const std::string& endpoint) {
  const std::string scheme = "ipc://";
  return endpoint.starts_with(scheme) ? endpoint.substr(scheme.size()) : "";
}

std::string with_host(const std::string& endpoint, const std::string& host) {
  for (const char* wildcard : {"tcp://0.0.0.0:", "tcp://[::]:"})
    if (endpoint.starts_with(wildcard)) return "tcp://" + host + endpoint.substr(endpoint.rfind(':'));
  return endpoint;
}

}  // namespace strake
