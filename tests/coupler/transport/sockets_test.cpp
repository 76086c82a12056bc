#include "coupler/transport/sockets.hpp"

#include "proto/error.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <span>
#include <thread>
#include <vector>

namespace strake {
namespace sockets_test {

using std::chrono::milliseconds;

TEST(CouplerSocket, TheSocketStandsInAPrivateFolderThatGoesWithIt) {
  namespace fs = std::filesystem;
  fs::path folder;
  {
    const CouplerSocket coupler;
    ASSERT_TRUE(coupler.endpoint().starts_with("ipc://"));
    EXPECT_LE(coupler.endpoint().size() - 6, 107u) << "a Unix socket's address holds no more";
    folder = fs::path(coupler.endpoint().substr(6)).parent_path();
    EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(folder));
}

TEST(CouplerSocket, LoopbackIsBoundOnRequestAndNothingBeyondIt) {
  const CouplerSocket coupler("tcp://127.0.0.1:*");
  EXPECT_TRUE(coupler.endpoint().starts_with("tcp://127.0.0.1:"));
  for (const char* outside :
       {"tcp://0.0.0.0:*", "tcp://*:*", "tcp://192.0.2.1:5555", "udp://127.0.0.1:1", "nonsense"})
    try {
      const CouplerSocket no(outside);
      FAIL() << outside;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::command_line) << outside;
    }
}

TEST(CouplerSocket, LargeArraysArriveWholeOverTcpAndTheirOwnerIsReleased) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  ParticipantSocket participant(coupler.endpoint());
  auto numbers = std::make_shared<std::vector<double>>(300'000, 1.5);
  const std::weak_ptr<void> watched = numbers;
  const std::string header = "header";
  participant.send({{std::as_bytes(std::span(header)), nullptr}});
  const auto hello = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(hello);
  coupler.admit(hello->peer);  // who sends so much unasked is cut
  participant.send(
      {{std::as_bytes(std::span(header)), nullptr}, {std::as_bytes(std::span(*numbers)), numbers}});
  numbers.reset();
  const auto message = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(message && message->parts.size() == 2);
  EXPECT_EQ(message->parts[1].bytes.size(), 300'000 * sizeof(double));
  double last = 0;
  std::memcpy(&last, message->parts[1].bytes.data() + 299'999 * sizeof(double), sizeof last);
  EXPECT_EQ(last, 1.5);
  for (int i = 0; i < 500 && !watched.expired(); ++i) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(watched.expired());
  EXPECT_TRUE(coupler.connected(message->peer));
}

TEST(CouplerSocket, AConnectionThatIsClosedNoLongerStands) {
  CouplerSocket coupler;
  std::string peer;
  {
    ParticipantSocket participant(coupler.endpoint());
    const std::string word = "word";
    participant.send({{std::as_bytes(std::span(word)), nullptr}});
    const auto message = coupler.receive(std::chrono::seconds(5));
    ASSERT_TRUE(message);
    peer = message->peer;
    EXPECT_TRUE(coupler.connected(peer));
    coupler.watch_close(peer);
    EXPECT_FALSE(coupler.left(peer));
  }
  for (int i = 0; i < 500 && coupler.connected(peer); ++i) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_FALSE(coupler.connected(peer));
  EXPECT_TRUE(coupler.left(peer)) << "it was closed at the other end";
}

}  // namespace sockets_test
}  // namespace strake
