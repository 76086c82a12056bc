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
  static bool tells(Hub& hub, const std::vector<std::string>& one_of) {
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
         std::chrono::steady_clock::now() < end;) {
      hub.receive(milliseconds(5));
      for (const auto& [what, times] : hub.take_strangers()) {
        for (const std::string& of_stranger : one_of)
          if (what == "127.0.0.1 " + of_stranger || what == "somebody " + of_stranger) return true;
      }
    }
    return false;
  }
  static LinkEvent first_failure(Line& line) {
    for (int i = 0; i < 100; ++i) {
      const auto event = line.next_event(milliseconds(50));
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
  Hub hub("tcp://127.0.0.1:*", {coupler_keys(), false});
  Line fluid(hub.endpoint(), keys("fluid")), structure(hub.endpoint(), keys("structure"));
  fluid.send(one_word());
  const auto first = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->key, "fluid");
  structure.send(one_word());
  const auto second = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(second);
  EXPECT_EQ(second->key, "structure");
  hub.send(first->peer, one_word());
  EXPECT_TRUE(fluid.receive(std::chrono::seconds(5)));
  EXPECT_TRUE(hub.connected(first->peer));
}

TEST_F(Network, AKeyThatIsNotListedStaysOutAndIsToldSo) {
  Hub hub("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys forged = keys("fluid");
  forged.own = new_key_pair();
  Line line(hub.endpoint(), forged);
  line.send(one_word());
  EXPECT_EQ(first_failure(line), LinkEvent::key_refused);
  EXPECT_TRUE(tells(hub, {"holds no key of this run"}));
  EXPECT_FALSE(hub.receive(milliseconds(50)));
}

TEST_F(Network, AKeyOfAnotherCouplerIsNoGreeting) {
  Hub hub("tcp://127.0.0.1:*", {coupler_keys(), false});
  ParticipantKeys other = keys("fluid");
  other.coupler = new_key_pair().public_key;
  Line line(hub.endpoint(), other);
  EXPECT_EQ(first_failure(line), LinkEvent::no_greeting);
  EXPECT_TRUE(tells(hub, {"has the key of another coupler"}));
}

TEST_F(Network, KeysOnOneSideOnlyAreNoGreeting) {
  Hub with("tcp://127.0.0.1:*", {coupler_keys(), false}), without("tcp://127.0.0.1:*");
  Line plain(with.endpoint()), encrypted(without.endpoint(), keys("fluid"));
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
    Hub hub("tcp://127.0.0.1:*", admission);
    const std::string noise(1000, '\xff');
    knock(hub.endpoint(), noise);
    EXPECT_TRUE(tells(hub, {encrypted ? "comes without a key" : unlike})) << encrypted;
    close(knock(hub.endpoint()));
    sockets_.pop_back();
    EXPECT_TRUE(tells(hub, {cut})) << encrypted;
    Line line(hub.endpoint(), encrypted ? std::optional(keys("fluid")) : std::nullopt);
    line.send(one_word());
    EXPECT_TRUE(hub.receive(std::chrono::seconds(5))) << encrypted;
  }
}

TEST_F(Network, ARequestForAWebPageIsNoParticipant) {
  Hub hub("tcp://127.0.0.1:*", {coupler_keys(), false});
  knock(hub.endpoint(),
        "GET / HTTP/1.1\r\nHost: localhost\r\nUser-Agent: curl/7.88.1\r\nAccept: */*\r\n\r\n");
  EXPECT_TRUE(tells(hub, {"left or was cut before its first word"}));
  EXPECT_FALSE(hub.receive(milliseconds(50)));
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
  Hub hub("tcp://127.0.0.1:*");
  Line line(hub.endpoint());
  line.send(one_word());
  const auto first = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  const std::int64_t before = peak_of_address_space();
  ASSERT_GT(before, 0);
  knock(hub.endpoint(), greeting() + ready + head_of_8_gib('\x02'));
  EXPECT_TRUE(tells(hub, {"left or was cut before its first word"}));
  knock(hub.endpoint(), greeting() + head_of_8_gib('\x06'));  // a command, during the greeting
  EXPECT_TRUE(tells(hub, {"left or was cut before its first word"}));
  EXPECT_LT(peak_of_address_space() - before, 1 << 20) << "room was made for it";
  EXPECT_TRUE(hub.connected(first->peer));
  hub.send(first->peer, one_word());
  EXPECT_TRUE(line.receive(std::chrono::seconds(5)));
}

TEST_F(Network, AFieldThatNoMessageCarriesIsRefusedWhereItComesFrom) {
  Hub hub;
  Line line(hub.endpoint());
  const std::byte one{};
  const std::span<const std::byte> large(&one, (std::size_t{1} << 28) + 1);  // only its size is tested
  EXPECT_THROW(line.send({{large, nullptr}}), Error);
  EXPECT_THROW(hub.send("nobody", {{large, nullptr}}), Error);
}

TEST_F(Network, AConnectionThatSaysNothingIsCut) {
  Hub hub("tcp://127.0.0.1:*");
  const int silent = knock(hub.endpoint());
  EXPECT_TRUE(tells(hub, {cut}));
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

/// The hub's own greeting and READY: it has taken ours.
void await_greeting(int socket) {
  std::array<char, 128> answer{};
  for (std::size_t heard = 0; heard < 64 + 2;) {
    const ssize_t n = recv(socket, answer.data(), answer.size(), 0);
    ASSERT_GT(n, 0);
    heard += static_cast<std::size_t>(n);
  }
}

TEST_F(Network, AMessageOfAStrangerThatNeverEndsIsCut) {
  Hub hub("tcp://127.0.0.1:*");
  const int endless = knock(hub.endpoint(), greeting_of_a_dealer());
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
    hub.receive(milliseconds(1));
    for (const auto& [what, times] : hub.take_strangers())
      told = told || what == "127.0.0.1 sent more than 64 kB and did not say who it is";
  }
  EXPECT_TRUE(told);
  for (int i = 0; i < 1000 && hub.somebody_is_new(); ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_FALSE(hub.somebody_is_new());
}

TEST_F(Network, OneThatTakesPartMaySendAsMuchAsItHasToSay) {
  Hub hub("tcp://127.0.0.1:*");
  Line line(hub.endpoint());
  line.send(one_word());
  const auto first = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  hub.admit(first->peer);
  const std::vector<std::byte> much(std::size_t{3} << 20);
  for (int i = 0; i < 3; ++i) {
    line.send({{much, nullptr}});
    const auto message = hub.receive(std::chrono::seconds(5));
    ASSERT_TRUE(message);
    EXPECT_EQ(message->parts.front().bytes.size(), much.size());
  }
  EXPECT_TRUE(hub.connected(first->peer));
  EXPECT_TRUE(hub.take_strangers().empty());
}

TEST_F(Network, ACrowdAtThePortDisturbsNobody) {
  Hub hub("tcp://127.0.0.1:*");
  Line line(hub.endpoint());
  line.send(one_word());
  const auto first = hub.receive(std::chrono::seconds(5));
  ASSERT_TRUE(first);
  constexpr int crowd = 1000;
  for (int i = 0; i < crowd; ++i) {  // more events than a queue of ZeroMQ takes by default, and none is read
    close(knock(hub.endpoint(), "nonsense"));
    sockets_.pop_back();
    if (i % 20 == 0) std::this_thread::sleep_for(milliseconds(2));  // a full backlog is tried again after 1 s
  }
  hub.send(first->peer, one_word());
  EXPECT_TRUE(line.receive(std::chrono::seconds(5)));
  line.send(one_word());
  EXPECT_TRUE(hub.receive(std::chrono::seconds(5)));
  EXPECT_TRUE(hub.connected(first->peer));
  int told = 0;
  for (int i = 0; i < 500 && told < crowd; ++i) {
    for (const auto& [what, times] : hub.take_strangers()) told += times;
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
  Hub hub("tcp://127.0.0.1:*");
  constexpr int crowd = 300, places = 64;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < crowd; ++i) knock(hub.endpoint());
  Line line(hub.endpoint());
  line.send(one_word());
  EXPECT_TRUE(hub.receive(std::chrono::seconds(2)));
  std::this_thread::sleep_for(milliseconds(50));
  const auto ended = std::count_if(sockets_.begin(), sockets_.end(), has_ended);
  EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(2900)) << "the time to greet is not over";
  EXPECT_GE(ended, crowd - places);
  EXPECT_LT(ended, crowd) << "few are let in";
}

TEST_F(Network, AMessageOfAStrangerThatNeverEndsIsCutOnAUnixSocketToo) {
  Hub hub;
  const int endless = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockets_.push_back(endless);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  const std::string path = hub.endpoint().substr(6);
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
  for (const auto& [what, times] : hub.take_strangers())
    told += what == "a program of this machine sent without a pause and did not say who it is" ? times : 0;
  EXPECT_EQ(told, 1);
}

TEST_F(Network, WhatOtherMachinesReachNeedsKeysOrPlainWords) {
  const auto problem = [](Admission admission) {  // of an address that no machine here has
    try {
      const Hub hub("tcp://192.0.2.1:5555", std::move(admission));
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
  Roster::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.deadlines.by_hand = milliseconds(500);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Roster roster(options);
  roster.attach("structure");
  std::string raw;
  for (std::size_t i = 0; i + 1 < roster.token().size(); i += 2)
    raw += static_cast<char>(std::stoi(roster.token().substr(i, 2), nullptr, 16));
  Line line(roster.endpoint(), keys("fluid"));
  line.send(wire::encode(
      wire::Reply{0, wire::Hello{wire::protocol, "structure", raw, "x", "1", std::string(32, '\0')}}, "x"));
  EXPECT_THROW(roster.connect("structure", {}), Error);
  EXPECT_EQ(said, "refused a participant: \"structure\" comes with the key of \"fluid\"\n");
}

TEST_F(Network, AParticipantWithoutAKeyInTheFolderIsRefusedBeforeAnyWait) {
  Roster::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  Roster roster(options);
  try {
    roster.attach("hull");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::case_file);
    EXPECT_EQ(e.problem(), "admits no participant \"hull\"");
  }
}

TEST_F(Network, WhoeverIsAwaitedForLongIsNamedLongBeforeTheLimit) {
  Roster::Options options;
  options.deadlines.tell = milliseconds(100);
  options.deadlines.by_hand = milliseconds(900);
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  Roster roster(options);
  roster.attach("fluid");
  try {
    roster.connect("fluid", {});
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
  Roster::Options options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.keys = coupler_keys();
  options.case_hash.fill(0x2a);
  const Roster roster(options);
  const std::string line =
      roster.command("fluid", {"/opt/a b/strake-fluid", {"--set", "title=it's"}, {}, 3, {}});
  EXPECT_TRUE(line.starts_with("STRAKE_TOKEN=" + roster.token() + " ")) << line;
  EXPECT_NE(line.find(" OMP_NUM_THREADS=3 "), std::string::npos) << line;
  EXPECT_NE(line.find(" STRAKE_KEY=" + (place_ / "keys/fluid.key").string() + " "), std::string::npos)
      << line;
  EXPECT_NE(
      line.find(" '/opt/a b/strake-fluid' --connect " + roster.endpoint() + " --name fluid --case-hash 2a2a"),
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
