#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <thread>

namespace strake {

/// What this machine calls itself.
std::string host_name();

/// The address of the other end of a connection, without its port.
std::string peer_address(int socket);

/// Bytes that the kernel has received from the other end of a tcp connection; 0 if unknown.
std::uint64_t bytes_received(int socket);

/// A thread that no signal reaches, nor the threads that it makes: signals are for the main thread, which
/// waits for the participants.
std::thread thread_without_signals(const std::function<void()>& work);

}  // namespace strake
