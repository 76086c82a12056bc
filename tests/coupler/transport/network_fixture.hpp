#pragma once

#include "coupler/transport/curve_keys.hpp"
#include "coupler/transport/sockets.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <chrono>
#include <span>
#include <string>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace strake {

using std::chrono::milliseconds;

using std::chrono::milliseconds;

class Network : public testing::Test {
 protected:
  void SetUp() override { make_keys(place_ / "keys", {"fluid", "structure"}); }
  void TearDown() override {
    for (int s : sockets_) close(s);
  }
  CouplerKeys coupler_keys() const { return read_coupler_keys(place_ / "keys"); }
  ParticipantKeys keys(const std::string& name) const {
    return read_participant_keys(key_file(place_ / "keys", name));
  }
  /// A plain tcp connection that says `words`.
  int knock(const std::string& endpoint, const std::string& words = {}) {
    const int s = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
    EXPECT_EQ(connect(s, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
    if (!words.empty()) {
      EXPECT_EQ(send(s, words.data(), words.size(), MSG_NOSIGNAL), static_cast<ssize_t>(words.size()));
    }
    sockets_.push_back(s);
    return s;
  }
  /// True if the socket reports that event of a stranger; its origin may be unknown by then.
  static bool tells(CouplerSocket& coupler, const std::vector<std::string>& one_of) {
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
         std::chrono::steady_clock::now() < end;) {
      coupler.receive(milliseconds(5));
      for (const auto& [what, times] : coupler.take_strangers()) {
        for (const std::string& of_stranger : one_of)
          if (what == "127.0.0.1 " + of_stranger || what == "somebody " + of_stranger) return true;
      }
    }
    return false;
  }
  static LinkEvent first_failure(ParticipantSocket& participant) {
    for (int i = 0; i < 100; ++i) {
      const auto event = participant.next_event(milliseconds(50));
      if (event && *event != LinkEvent::connected && *event != LinkEvent::other) return *event;
    }
    return LinkEvent::other;
  }

  TemporaryFolder place_;
  std::vector<int> sockets_;
};

// Which end notices first that keys stand on one side only is a matter of luck.
inline const std::string unlike = "does not greet plainly, and this run has no keys";
inline const std::string cut = "did not greet as ZeroMQ does";

inline const std::string word = "word";
inline wire::Parts one_word() {
  return {{std::as_bytes(std::span(word)), nullptr}};
}

}  // namespace strake
