// Strangers and crowds at the port of a run: garbage, endless messages, silence. All on loopback.

#include "coupler/processes/participants_state.hpp"
#include "proto/error.hpp"
#include "tests/coupler/transport/network_fixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <span>
#include <sys/socket.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace strake {
namespace strangers_test {

TEST_F(Network, GarbageIsNamedAndTheRightOneStillComesIn) {
  for (const bool encrypted : {false, true}) {
    Admission admission;
    if (encrypted) admission.keys = coupler_keys();
    CouplerSocket coupler("tcp://127.0.0.1:*", admission);
    const std::string noise(1000, '\xff');
    knock(coupler.endpoint(), noise);
    EXPECT_TRUE(tells(coupler, {encrypted ? "comes without a key" : unlike})) << encrypted;
    close(knock(coupler.endpoint()));
    sockets_.pop_back();
    EXPECT_TRUE(tells(coupler, {cut})) << encrypted;
    ParticipantSocket participant(coupler.endpoint(),
                                  encrypted ? std::optional(keys("fluid")) : std::nullopt);
    participant.send(one_word());
    EXPECT_TRUE(coupler.receive(std::chrono::seconds(5))) << encrypted;
  }
}

TEST_F(Network, ARequestForAWebPageIsNoParticipant) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  knock(coupler.endpoint(),
        "GET / HTTP/1.1\r\nHost: localhost\r\nUser-Agent: curl/7.88.1\r\nAccept: */*\r\n\r\n");
  EXPECT_TRUE(tells(coupler, {"left or was cut before its first word"}));
  EXPECT_FALSE(coupler.receive(milliseconds(50)));
}

/// The first bytes of a ZeroMQ socket without encryption keys (its RFC 23). They are signature, version 3.0,
/// NULL, as a client; then the command READY with the kind of socket.
std::string greeting() {
  std::string text = "\xff" + std::string(8, '\0') + "\x7f\x03" + std::string(1, '\0') + "NULL";
  return text + std::string(64 - text.size(), '\0');
}
const std::string ready = std::string("\x04\x1c\x05READY\x0bSocket-Type\0\0\0\x06", 24) + "DEALER";

/// The head of a frame of 8 GiB: a long one, its size in eight bytes.
std::string head_of_8_gib(char flags) {
  return std::string(1, flags) + std::string("\0\0\0\x02\0\0\0\0", 8);
}

std::int64_t peak_of_address_space() {  // [KiB]
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmPeak:")) return std::stoll(line.substr(7));
  return 0;
}

TEST_F(Network, AFrameOf8GiBIsNotWaitedForAndTheRunGoesOn) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  ParticipantSocket participant(coupler.endpoint());
  participant.send(one_word());
  const auto first = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  const std::int64_t before = peak_of_address_space();
  ASSERT_GT(before, 0);
  knock(coupler.endpoint(), greeting() + ready + head_of_8_gib('\x02'));
  EXPECT_TRUE(tells(coupler, {"left or was cut before its first word"}));
  knock(coupler.endpoint(), greeting() + head_of_8_gib('\x06'));  // a command, during the greeting
  EXPECT_TRUE(tells(coupler, {"left or was cut before its first word"}));
  EXPECT_LT(peak_of_address_space() - before, 1 << 20) << "room was made for it";
  EXPECT_TRUE(coupler.connected(first->peer));
  coupler.send(first->peer, one_word());
  EXPECT_TRUE(participant.receive(std::chrono::seconds(5)));
}

TEST_F(Network, AFieldThatNoMessageCarriesIsRefusedWhereItComesFrom) {
  CouplerSocket coupler;
  ParticipantSocket participant(coupler.endpoint());
  const std::byte one{};
  const std::span<const std::byte> large(&one, (std::size_t{1} << 28) + 1);  // only its size is looked at
  EXPECT_THROW(participant.send({{large, nullptr}}), Error);
  EXPECT_THROW(coupler.send("nobody", {{large, nullptr}}), Error);
}

TEST_F(Network, AConnectionThatSaysNothingIsCut) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  const int silent = knock(coupler.endpoint());
  EXPECT_TRUE(tells(coupler, {cut}));
  char byte[64];
  while (recv(silent, byte, sizeof byte, 0) > 0) {
  }  // its greeting, then the end
}

/// ZMTP 3.0 (RFC 23): greeting with the NULL mechanism, then READY as a DEALER.
std::string greeting_of_a_dealer() {
  std::string words = {'\xff', 0, 0, 0, 0, 0, 0, 0, 1, '\x7f', 3, 0};
  words += "NULL" + std::string(16, '\0') + std::string(32, '\0');
  const std::string ready =
      std::string("\x05READY\x0bSocket-Type") + std::string(3, '\0') + "\x06" + "DEALER";
  return words + '\x04' + static_cast<char>(ready.size()) + ready;
}

/// The coupler's own greeting and READY: it has taken ours.
void await_greeting(int socket) {
  std::array<char, 128> answer{};
  for (std::size_t heard = 0; heard < 64 + 2;) {
    const ssize_t n = recv(socket, answer.data(), answer.size(), 0);
    ASSERT_GT(n, 0);
    heard += static_cast<std::size_t>(n);
  }
}

TEST_F(Network, AMessageOfAStrangerThatNeverEndsIsCut) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  const int endless = knock(coupler.endpoint(), greeting_of_a_dealer());
  await_greeting(endless);
  std::string frames;  // of one byte each, more to follow
  for (int i = 0; i < 20000; ++i) frames += std::string("\x01\x01") + "a";
  constexpr std::size_t far_too_much = std::size_t{1} << 27;
  std::size_t sent = 0;
  bool told = false;
  while (!told && sent < far_too_much) {
    const std::size_t begin = sent % frames.size();  // a part of them may have gone
    const ssize_t n =
        send(endless, frames.data() + begin, frames.size() - begin, MSG_NOSIGNAL | MSG_DONTWAIT);
    sent += n > 0 ? static_cast<std::size_t>(n) : 0;
    coupler.receive(milliseconds(1));
    for (const auto& [what, times] : coupler.take_strangers())
      told = told || what == "127.0.0.1 sent more than 64 kB and did not say who it is";
  }
  EXPECT_TRUE(told);
  for (int i = 0; i < 1000 && coupler.somebody_is_new(); ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_FALSE(coupler.somebody_is_new());
}

TEST_F(Network, OneThatTakesPartMaySendAsMuchAsItHasToSay) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  ParticipantSocket participant(coupler.endpoint());
  participant.send(one_word());
  const auto first = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  coupler.admit(first->peer);
  const std::vector<std::byte> much(std::size_t{3} << 20);
  for (int i = 0; i < 3; ++i) {
    participant.send({{much, nullptr}});
    const auto message = coupler.receive(std::chrono::seconds(5));
    ASSERT_TRUE(message);
    EXPECT_EQ(message->parts.front().bytes.size(), much.size());
  }
  EXPECT_TRUE(coupler.connected(first->peer));
  EXPECT_TRUE(coupler.take_strangers().empty());
}

TEST_F(Network, ACrowdAtThePortDisturbsNobody) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  ParticipantSocket participant(coupler.endpoint());
  participant.send(one_word());
  const auto first = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  constexpr int crowd = 1000;
  for (int i = 0; i < crowd; ++i) {  // more events than a queue of ZeroMQ holds by default, and nobody looks
    close(knock(coupler.endpoint(), "nonsense"));
    sockets_.pop_back();
    if (i % 20 == 0) std::this_thread::sleep_for(milliseconds(2));  // a full backlog is tried again after 1 s
  }
  coupler.send(first->peer, one_word());
  EXPECT_TRUE(participant.receive(std::chrono::seconds(5)));
  participant.send(one_word());
  EXPECT_TRUE(coupler.receive(std::chrono::seconds(5)));
  EXPECT_TRUE(coupler.connected(first->peer));
  int told = 0;
  for (int i = 0; i < 500 && told < crowd; ++i) {
    for (const auto& [what, times] : coupler.take_strangers()) told += times;
    std::this_thread::sleep_for(milliseconds(2));
  }
  EXPECT_EQ(told, crowd);
}

/// Whether the other end has closed it, or sent something.
bool has_ended(int socket) {
  char bytes[256];
  ssize_t n = 0;
  do n = recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
  while (n > 0);
  return n == 0 || errno != EAGAIN;
}

TEST_F(Network, OfACrowdThatSaysNothingFewStandAndAParticipantStillComesIn) {
  CouplerSocket coupler("tcp://127.0.0.1:*");
  constexpr int crowd = 300, places = 64;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < crowd; ++i) knock(coupler.endpoint());
  ParticipantSocket participant(coupler.endpoint());
  participant.send(one_word());
  EXPECT_TRUE(coupler.receive(std::chrono::seconds(2)));
  std::this_thread::sleep_for(milliseconds(50));
  const auto ended = std::count_if(sockets_.begin(), sockets_.end(), has_ended);
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(2900)) << "the time to greet is not over";
  EXPECT_GE(ended, crowd - places);
  EXPECT_LT(ended, crowd) << "few are let in";
}

TEST_F(Network, AMessageOfAStrangerThatNeverEndsIsCutOnAUnixSocketToo) {
  CouplerSocket coupler;
  const int endless = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockets_.push_back(endless);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  const std::string path = coupler.endpoint().substr(6);
  std::copy(path.begin(), path.end(), to.sun_path);
  ASSERT_EQ(connect(endless, reinterpret_cast<sockaddr*>(&to), sizeof to), 0);
  const std::string words = greeting_of_a_dealer();
  ASSERT_EQ(send(endless, words.data(), words.size(), MSG_NOSIGNAL), static_cast<ssize_t>(words.size()));
  await_greeting(endless);
  std::string frames;  // of one byte each, more to follow
  for (int i = 0; i < 20000; ++i) frames += std::string("\x01\x01") + "a";
  constexpr std::size_t far_too_much = std::size_t{1} << 27;
  std::size_t sent = 0;
  while (sent < far_too_much) {
    const std::size_t begin = sent % frames.size();  // a part of them may have gone
    const ssize_t n = send(endless, frames.data() + begin, frames.size() - begin, MSG_NOSIGNAL);
    if (n <= 0) break;
    sent += static_cast<std::size_t>(n);
  }
  EXPECT_LT(sent, far_too_much);
  int told = 0;
  for (const auto& [what, times] : coupler.take_strangers())
    told += what == "a program of this machine sent without a pause and did not say who it is" ? times : 0;
  EXPECT_EQ(told, 1);
}

TEST(StrangerLog, ToldOnceThenByNumberEverMoreRarely) {
  StrangerLog log;
  const StrangerLog::Clock::time_point start{};
  const auto at = [&](int seconds) { return start + std::chrono::seconds(seconds); };
  EXPECT_EQ(log.note("x", 3, at(0)), std::vector<std::string>{"x"});
  EXPECT_TRUE(log.note("x", 5, at(1)).empty());
  EXPECT_TRUE(log.due(at(9)).empty());
  EXPECT_EQ(log.due(at(10)), std::vector<std::string>{"x (7 more in 10 s)"});
  EXPECT_TRUE(log.note("x", 1, at(11)).empty());
  EXPECT_TRUE(log.due(at(29)).empty());
  EXPECT_EQ(log.due(at(30)), std::vector<std::string>{"x (1 more in 20 s)"});
  std::size_t lines = 0;
  for (int i = 0; i < 1000; ++i) lines += log.note(fmt::format("kind {}", i), 1, at(31)).size();
  EXPECT_LE(lines, 20u) << "words of their own choice do not make more lines";
  EXPECT_TRUE(log.due(at(2000)).size() <= 2);
  EXPECT_EQ(log.note("x", 1, at(4000)).size(), 1u) << "after a long silence it is news again";
  EXPECT_EQ(harmless("a\nb\x1b[31m"), R"(a\x0ab\x1b[31m)");
  EXPECT_EQ(harmless(std::string(500, 'x')).size(), 203u);
}

}  // namespace strangers_test
}  // namespace strake
