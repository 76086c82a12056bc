// Who comes in by tcp and who does not: keys, strangers, crowds. All on loopback.

#include "coupler/processes/remote.hpp"
#include "coupler/processes/stranger_log.hpp"
#include "coupler/transport/curve_keys.hpp"
#include "coupler/transport/sockets.hpp"
#include "proto/error.hpp"
#include "tests/proto/temporary_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <sys/socket.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace strake {
namespace {

namespace fs = std::filesystem;
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
const std::string unlike = "does not greet plainly, and this run has no keys";
const std::string cut = "did not greet as ZeroMQ does";

const std::string word = "word";
wire::Parts one_word() {
  return {{std::as_bytes(std::span(word)), nullptr}};
}

TEST_F(Network, HoldersOfAListedKeyComeInAndAreKnownByIt) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantSocket fluid(coupler.endpoint(), keys("fluid")),
      structure(coupler.endpoint(), keys("structure"));
  fluid.send(one_word());
  const auto first = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->key, "fluid");
  structure.send(one_word());
  const auto second = coupler.receive(std::chrono::seconds(5));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->key, "structure");
  coupler.send(first->peer, one_word());
  EXPECT_TRUE(fluid.receive(std::chrono::seconds(5)));
  EXPECT_TRUE(coupler.connected(first->peer));
}

TEST_F(Network, AKeyThatIsNotListedStaysOutAndIsToldSo) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys forged = keys("fluid");
  forged.own = new_key_pair();
  ParticipantSocket participant(coupler.endpoint(), forged);
  participant.send(one_word());
  EXPECT_EQ(first_failure(participant), LinkEvent::key_refused);
  EXPECT_TRUE(tells(coupler, {"holds no key of this run"}));
  EXPECT_FALSE(coupler.receive(milliseconds(50)));
}

TEST_F(Network, AKeyOfAnotherCouplerIsNoGreeting) {
  CouplerSocket coupler("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys other = keys("fluid");
  other.coupler = new_key_pair().public_key;
  ParticipantSocket participant(coupler.endpoint(), other);
  EXPECT_EQ(first_failure(participant), LinkEvent::no_greeting);
  EXPECT_TRUE(tells(coupler, {"has the key of another coupler"}));
}

TEST_F(Network, KeysOnOneSideOnlyAreNoGreeting) {
  CouplerSocket with("tcp://127.0.0.1:*", {coupler_keys(), false}), without("tcp://127.0.0.1:*");
  ParticipantSocket plain(with.endpoint()), encrypted(without.endpoint(), keys("fluid"));
  const auto failed = [](LinkEvent e) {
    return e == LinkEvent::no_greeting || e == LinkEvent::other_greeting;
  };
  EXPECT_TRUE(failed(first_failure(plain)));
  EXPECT_TRUE(tells(with, {"comes without a key", cut}));
  EXPECT_TRUE(failed(first_failure(encrypted)));
  EXPECT_TRUE(tells(without, {unlike, cut}));
}

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

TEST_F(Network, WhatOtherMachinesReachNeedsKeysOrPlainWords) {
  const auto problem = [](Admission admission) {  // of an address that no machine here has
    try {
      const CouplerSocket coupler("tcp://192.0.2.1:5555", std::move(admission));
    } catch (const Error& e) {
      return e.problem();
    }
    return std::string();
  };
  EXPECT_EQ(problem({}), "can be reached from other machines, and nothing protects it");
  EXPECT_TRUE(problem({coupler_keys(), false}).starts_with("cannot be bound"));
  EXPECT_TRUE(problem({std::nullopt, true}).starts_with("cannot be bound"));
  for (const char* here :
       {"ipc:///tmp/a", "tcp://127.0.0.1:5", "tcp://127.1.2.3:*", "tcp://localhost:5", "tcp://[::1]:5"})
    EXPECT_FALSE(leaves_machine(here)) << here;
  for (const char* away : {"tcp://0.0.0.0:5", "tcp://*:5", "tcp://127.0.0.1.example.org:5",
                           "tcp://192.0.2.1:5", "tcp://[::]:5", "tcp://eth0:5", "nonsense"})
    EXPECT_TRUE(leaves_machine(away)) << away;
}

TEST_F(Network, AParticipantMayNotUseTheKeyOfAnother) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.deadlines.by_hand = milliseconds(500);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Participants participants(options);
  participants.attach("structure");
  std::string raw;
  for (std::size_t i = 0; i + 1 < participants.token().size(); i += 2)
    raw += static_cast<char>(std::stoi(participants.token().substr(i, 2), nullptr, 16));
  ParticipantSocket participant(participants.endpoint(), keys("fluid"));
  participant.send(wire::encode(
      wire::Reply{0, wire::Hello{wire::protocol, "structure", raw, "x", "1", std::string(32, '\0')}}, "x"));
  EXPECT_THROW(participants.connect("structure", {}), Error);
  EXPECT_EQ(said, "refused a participant: \"structure\" comes with the key of \"fluid\"\n");
}

TEST_F(Network, AParticipantWithoutAKeyInTheFolderIsRefusedBeforeAnyWait) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  Participants participants(options);
  try {
    participants.attach("hull");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_EQ(e.problem(), "admits no participant \"hull\"");
  }
}

TEST_F(Network, WhoeverIsAwaitedForLongIsNamedLongBeforeTheLimit) {
  Participants::Options options;
  options.deadlines.tell = milliseconds(100);
  options.deadlines.by_hand = milliseconds(900);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Participants participants(options);
  participants.attach("fluid");
  try {
    participants.connect("fluid", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::participant_lost);
    EXPECT_EQ(e.where(), "fluid");
    EXPECT_TRUE(e.problem().starts_with("has not been started by hand within 0.9")) << e.problem();
  }
  EXPECT_TRUE(said.starts_with("waiting for fluid, to be started by hand, for 0.1")) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 4) << said;  // after 0.1, 0.2, 0.4 and 0.8 s
}

TEST_F(Network, TheCommandLineOfOneStartedByHandCanBePastedIntoAShell) {
  Participants::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.case_hash.fill(0x2a);
  const Participants participants(options);
  const std::string line =
      participants.command("fluid", {"/opt/a b/strake-fluid", {"--set", "title=it's"}, {}, 3, {}});
  EXPECT_TRUE(line.starts_with("STRAKE_TOKEN=" + participants.token() + " ")) << line;
  EXPECT_NE(line.find(" OMP_NUM_THREADS=3 "), std::string::npos) << line;
  EXPECT_NE(line.find(" STRAKE_KEY=" + (place_ / "keys/fluid.key").string() + " "), std::string::npos)
      << line;
  EXPECT_NE(line.find(" '/opt/a b/strake-fluid' --connect " + participants.endpoint() +
                      " --name fluid --case-hash 2a2a"),
            std::string::npos)
      << line;
  EXPECT_TRUE(line.ends_with(" --set 'title=it'\\''s'")) << line;
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

}  // namespace
}  // namespace strake
