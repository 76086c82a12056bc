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
namespace {

using std::chrono::milliseconds;

TEST(Hub, TheSocketStandsInAPrivateFolderThatGoesWithIt) {
  namespace fs = std::filesystem;
  fs::path folder;
  {
    const Hub hub;
    ASSERT_TRUE(hub.endpoint().starts_with("ipc://"));
    EXPECT_LE(hub.endpoint().size() - 6, 107u) << "a Unix socket's address holds no more";
    folder = fs::path(hub.endpoint().substr(6)).parent_path();
    EXPECT_EQ(fs::status(folder).permissions(), fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(folder));
}

TEST(Hub, LoopbackIsBoundOnRequestAndNothingBeyondIt) {
  const Hub hub("tcp://127.0.0.1:*");
  EXPECT_TRUE(hub.endpoint().starts_with("tcp://127.0.0.1:"));
  for (const char* outside :
       {"tcp://0.0.0.0:*", "tcp://*:*", "tcp://192.0.2.1:5555", "udp://127.0.0.1:1", "nonsense"})
    try {
      const Hub no(outside);
      FAIL() << outside;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::command_line) << outside;
    }
}

TEST(Hub, LargeArraysArriveWholeOverTcpAndTheirOwnerIsReleased) {
  Hub hub("tcp://127.0.0.1:*");
  Line line(hub.endpoint());
  auto numbers = std::make_shared<std::vector<double>>(300'000, 1.5);
  const std::weak_ptr<void> watched = numbers;
  const std::string header = "header";
  line.send({{std::as_bytes(std::span(header)), nullptr}});
  const auto hello = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(hello);
  hub.admit(hello->peer);  // who sends so much unasked is cut
  line.send({{std::as_bytes(std::span(header)), nullptr}, {std::as_bytes(std::span(*numbers)), numbers}});
  numbers.reset();
  const auto message = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(message && message->parts.size() == 2);
  EXPECT_EQ(message->parts[1].bytes.size(), 300'000 * sizeof(double));
  double last = 0;
  std::memcpy(&last, message->parts[1].bytes.data() + 299'999 * sizeof(double), sizeof last);
  EXPECT_EQ(last, 1.5);
  for (int i = 0; i < 500 && !watched.expired(); ++i) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(watched.expired());
  EXPECT_TRUE(hub.connected(message->peer));
}

TEST(Hub, AConnectionThatIsClosedNoLongerStands) {
  Hub hub;
  std::string peer;
  {
    Line line(hub.endpoint());
    const std::string word = "word";
    line.send({{std::as_bytes(std::span(word)), nullptr}});
    const auto message = hub.receive(std::chrono::seconds(5));
    ASSERT_TRUE(message);
    peer = message->peer;
    EXPECT_TRUE(hub.connected(peer));
    hub.keep_witness(peer);
    EXPECT_FALSE(hub.left(peer));
  }
  for (int i = 0; i < 500 && hub.connected(peer); ++i) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_FALSE(hub.connected(peer));
  EXPECT_TRUE(hub.left(peer)) << "it was closed at the other end";
}

}  // namespace
}  // namespace strake
