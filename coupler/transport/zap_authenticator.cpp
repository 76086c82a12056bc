#include "coupler/transport/zap_authenticator.hpp"

#include "coupler/transport/system_calls.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace strake {

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
