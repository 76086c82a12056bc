#pragma once

#include <cstddef>
#include <string>

/// Where participants connect, as it is written in a case: ipc://PATH, ipc://@NAME or tcp://ADDRESS:PORT.
namespace strake {

inline constexpr std::size_t unix_path = 107;  // bytes of a Unix socket's address
// Connections that wait to be accepted. Where the queue is full, tcp tries again only after a second.
inline constexpr int accept_queue = 1000;

/// What is wrong with an endpoint, in words that follow it; empty where nothing is.
std::string problem_of_endpoint(const std::string& endpoint);

/// Whether other machines can reach the endpoint: neither ipc nor loopback.
bool leaves_machine(const std::string& endpoint);

/// "ipc:///tmp/a" → "/tmp/a"; empty for tcp.
std::string path_of(const std::string& endpoint);

/// "tcp://0.0.0.0:5555" → "tcp://HOST:5555"; any other endpoint as it is.
std::string with_host(const std::string& endpoint, const std::string& host);

}  // namespace strake
