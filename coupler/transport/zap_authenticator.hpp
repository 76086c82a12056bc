#pragma once

#include <zmq.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace strake {

/// Admits to ZeroMQ whoever has one of the admitted encryption keys (the request is described in RFC 27/ZAP).
/// It runs in a thread of its own, since the coupler may be computing.
class ZapAuthenticator {
 public:
  /// admitted: participant → public key in Z85.
  ZapAuthenticator(zmq::context_t&, const std::map<std::string, std::string>& admitted);
  ~ZapAuthenticator();  // shuts the context down, which is what its thread waits for
  ZapAuthenticator(const ZapAuthenticator&) = delete;
  ZapAuthenticator& operator=(const ZapAuthenticator&) = delete;

  /// Addresses that came with another key, since the last call.
  std::vector<std::string> take_refused();

 private:
  void run();
  std::vector<std::string> hear();
  void answer(const std::vector<std::string>& request);

  zmq::context_t& context_;
  zmq::socket_t socket_;
  std::map<std::array<std::uint8_t, 32>, std::string> name_of_;
  std::mutex mutex_;
  std::vector<std::string> refused_;
  std::thread thread_;
};

}  // namespace strake
